// A force-feedback yoke on a Teensy 4.1: law and feel as forcefeel exported them, every half millisecond. See ../README.md.
#include <Arduino.h>

#include "yoke_law.h"

constexpr int FORCE_PIN = A0, MOTOR_PIN = A1, COLUMN_PIN = A2; // 0 to 3.3 V, zero in the middle
constexpr int CURRENT_PIN = 10; // PWM, no current in the middle
constexpr int ENABLE_PIN = 11; // high: the drive has power
constexpr int STOP_PIN = 12; // closed to ground: may run
constexpr float FORCE_RANGE = 500.0F, TRAVEL_RANGE = 0.08F, CURRENT_RANGE = 25.0F; // N, m, A either way
constexpr float MOST_FORCE = 300.0F; // N at the load cell; beyond it the drive goes off
constexpr float MIDDLE = 2048.0F; // of 12 bits

static IntervalTimer timer;
static yoke_state state;
static float current; // in A, from a sample to the next
static bool running, armed;

static float measured(int pin, float range)
{
    return (static_cast<float>(analogRead(pin)) - MIDDLE) * (range / MIDDLE);
}

static void drive(float amperes, bool on)
{
    analogWrite(CURRENT_PIN, static_cast<int>(MIDDLE + 0.5F + amperes * ((MIDDLE - 1.0F) / CURRENT_RANGE)));
    digitalWrite(ENABLE_PIN, on ? HIGH : LOW);
}

static void period()
{
    drive(current, running);
    yoke_input in = {};
    in.force = measured(FORCE_PIN, FORCE_RANGE);
    in.position = measured(MOTOR_PIN, TRAVEL_RANGE);
    in.base = measured(COLUMN_PIN, TRAVEL_RANGE);
    in.stiffness_factor = 1.0F;
    yoke_output out = {};
    if (digitalRead(STOP_PIN) != LOW) {
        running = false;
        armed = true; // after a start, and after a fault, the switch has to be open once
    } else if (!running && armed) {
        running = yoke_law_reset(&state, &in) == yoke_OK;
        armed = false;
    }
    if (running) {
        running = (yoke_law_step(&state, &in, &out) == yoke_OK) && (in.force < MOST_FORCE) && (in.force > -MOST_FORCE);
    }
    current = running ? out.command : 0.0F;
    if (!running) {
        drive(0.0F, false);
    }
}

void setup()
{
    pinMode(ENABLE_PIN, OUTPUT);
    pinMode(STOP_PIN, INPUT_PULLUP);
    analogReadResolution(12);
    analogWriteResolution(12);
    analogWriteFrequency(CURRENT_PIN, 36000);
    drive(0.0F, false);
    timer.begin(period, yoke_PERIOD_S * 1e6F);
}

void loop()
{
}
