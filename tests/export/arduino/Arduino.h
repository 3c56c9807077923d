// What the example's sketch calls, as Teensyduino declares it; main.cpp has the pins.
#pragma once

constexpr int A0 = 14, A1 = 15, A2 = 16;
constexpr int LOW = 0, HIGH = 1, OUTPUT = 1, INPUT_PULLUP = 2;

int analogRead(int pin);
void analogReadResolution(unsigned int bits);
void analogWrite(int pin, int value);
void analogWriteFrequency(int pin, float hertz);
void analogWriteResolution(int bits);
int digitalRead(int pin);
void digitalWrite(int pin, int value);
void pinMode(int pin, int mode);

class IntervalTimer {
public:
    bool begin(void (*function)(), float microseconds);
};
