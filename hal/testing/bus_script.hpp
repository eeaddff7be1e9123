/// @file
/// Transactions that a test expects on a bus, and the answers. For tests only, never in firmware.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::hal::testing {

/// One expected operation: bytes that must be written, the answer to a read of that length, or
/// both.
struct ScriptedOperation {
  std::optional<std::vector<std::uint8_t>> bytes;
  std::optional<std::vector<std::uint8_t>> answer;
};
inline ScriptedOperation writes(std::vector<std::uint8_t> bytes) {
  return {std::move(bytes), std::nullopt};
}
inline ScriptedOperation reads(std::vector<std::uint8_t> answer) {
  return {std::nullopt, std::move(answer)};
}
inline ScriptedOperation exchanges(std::vector<std::uint8_t> bytes,
                                   std::vector<std::uint8_t> answer) {
  return {std::move(bytes), std::move(answer)};
}

/// The bus fails in the middle of a transaction: operations before `operation` take place.
struct FailureAt {
  std::size_t operation;
  BusError error;
};

/// One expected transaction.
struct ScriptedTransaction {
  std::optional<I2cAddress> address;  ///< none on SPI
  std::vector<ScriptedOperation> operations;
  std::optional<FailureAt> failure;
};

/// The transactions still to come. A difference is a test failure, and so is a script that is not
/// used up when it goes out of scope.
class BusScript {
 public:
  BusScript() = default;
  BusScript(const BusScript&) = delete;
  BusScript& operator=(const BusScript&) = delete;
  ~BusScript() {
    if (!expected_.empty()) {
      ADD_FAILURE() << expected_.size() << " scripted transactions did not happen";
    }
  }

  void expect(ScriptedTransaction transaction) { expected_.push_back(std::move(transaction)); }

  /// Compares and answers. After a difference the answer is BusError::io.
  core::Result<void, BusError> play(std::optional<I2cAddress> address,
                                    std::span<const Operation> operations) {
    const std::size_t number = played_++;
    if (expected_.empty()) {
      ADD_FAILURE() << "transaction " << number << " is not in the script";
      return core::Unexpected{BusError::io};
    }
    const ScriptedTransaction expected = std::move(expected_.front());
    expected_.pop_front();
    if (const auto difference = compare(expected, address, operations); !difference.empty()) {
      ADD_FAILURE() << "transaction " << number << ": " << difference;
      return core::Unexpected{BusError::io};
    }
    return answer(expected, operations);
  }

 private:
  static std::string compare(const ScriptedTransaction& expected, std::optional<I2cAddress> address,
                             std::span<const Operation> operations) {
    if (address != expected.address) return "another device address than scripted";
    if (operations.size() != expected.operations.size()) {
      return std::to_string(operations.size()) + " operations, scripted " +
             std::to_string(expected.operations.size());
    }
    for (std::size_t i = 0; i < operations.size(); ++i) {
      const ScriptedOperation& scripted = expected.operations[i];
      if (!is_same(operations[i], scripted)) {
        return "operation " + std::to_string(i) + " is " + describe(operations[i]) + ", scripted " +
               describe(scripted);
      }
    }
    return {};
  }

  static bool is_same(const Operation& operation, const ScriptedOperation& scripted) {
    const bool answers = operation.is_read() || operation.is_exchange();
    if (answers != scripted.answer.has_value()) return false;
    if (operation.is_read() == scripted.bytes.has_value()) return false;
    if (scripted.answer && operation.size() != scripted.answer->size()) return false;
    return !scripted.bytes || std::ranges::equal(operation.bytes(), *scripted.bytes);
  }

  static core::Result<void, BusError> answer(const ScriptedTransaction& expected,
                                             std::span<const Operation> operations) {
    for (std::size_t i = 0; i < operations.size(); ++i) {
      if (expected.failure && expected.failure->operation == i) {
        return core::Unexpected{expected.failure->error};
      }
      if (const auto& scripted = expected.operations[i].answer) {
        std::ranges::copy(*scripted, operations[i].buffer().begin());
      }
    }
    return {};
  }

  static std::string describe(const Operation& operation) {
    if (operation.is_read()) return "a read of " + std::to_string(operation.size());
    return (operation.is_exchange() ? "an exchange of" : "a write of") +
           hexadecimal(operation.bytes());
  }
  static std::string describe(const ScriptedOperation& operation) {
    if (!operation.bytes) return "a read of " + std::to_string(operation.answer->size());
    return (operation.answer ? "an exchange of" : "a write of") + hexadecimal(*operation.bytes);
  }
  static std::string hexadecimal(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string text;
    for (const std::uint8_t byte : bytes) {
      text += {' ', kDigits[byte >> 4U], kDigits[byte & 0xFU]};
    }
    return text;
  }

  std::deque<ScriptedTransaction> expected_;
  std::size_t played_ = 0;
};

}  // namespace zerorate::hal::testing
