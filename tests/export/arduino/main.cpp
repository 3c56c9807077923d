// Runs the sketch on this machine: each line of the input is the pins of a period, each of the output what it wrote first and last.
#include "Arduino.h"

#include <cstdio>

static int pins[64], first = -1;
static void (*timed)();

int analogRead(int pin) { return pins[pin]; }
void analogReadResolution(unsigned int) {}
void analogWriteFrequency(int, float) {}
void analogWriteResolution(int) {}
int digitalRead(int pin) { return pins[pin]; }
void digitalWrite(int pin, int value) { pins[pin] = value; }
void pinMode(int, int) {}

void analogWrite(int pin, int value)
{
    pins[pin] = value;
    first = (first < 0) ? value : first;
}

bool IntervalTimer::begin(void (*function)(), float microseconds)
{
    timed = function;
    std::printf("%.3f %d %d\n", double(microseconds), pins[10], pins[11]);
    return true;
}

void setup();
void loop();

int main()
{
    setup();
    while (std::scanf("%d %d %d %d", &pins[A0], &pins[A1], &pins[A2], &pins[12]) == 4) {
        first = -1;
        timed();
        loop();
        std::printf("%d %d %d\n", first, pins[10], pins[11]);
    }
}
