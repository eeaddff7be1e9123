/* The part of Arduino's interface that the example uses, on this machine. Time is simulated: each
   look at the clock takes 20 us, and the counter starts two minutes before it wraps. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
uint32_t micros(void);
void delay(uint32_t ms);
#ifdef __cplusplus
}

struct SerialPort {
  void begin(unsigned long baud);
  void print(const char* text);
  void print(float number);
  void println(const char* text);
  void println(float number);
};
extern SerialPort Serial;

void setup();
void loop();
#endif
