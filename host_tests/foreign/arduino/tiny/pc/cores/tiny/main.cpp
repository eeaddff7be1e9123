#include <Arduino.h>

#include <cstdio>

#include <board.h>

namespace {
constexpr uint32_t kTwoMinutes_us = 120'000'000;
uint64_t time_us;
}  // namespace

double board_seconds() {
  return 1e-6 * static_cast<double>(time_us);
}

uint32_t micros() {
  time_us += 20;
  return static_cast<uint32_t>(time_us - kTwoMinutes_us);
}
void delay(uint32_t ms) {
  time_us += 1000ULL * ms;
}

SerialPort Serial;
void SerialPort::begin(unsigned long) {}
void SerialPort::print(const char* text) {
  std::fputs(text, stdout);
}
void SerialPort::print(float number) {
  std::printf("%.2f", static_cast<double>(number));
}
void SerialPort::println(const char* text) {
  std::printf("%s\n", text);
}
void SerialPort::println(float number) {
  std::printf("%.2f\n", static_cast<double>(number));
}

int main() {
  setup();
  while (board_seconds() < 240.0) loop();
}
