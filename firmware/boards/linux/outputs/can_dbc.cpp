#include "firmware/boards/linux/outputs/can_dbc.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>

#include "firmware/boards/linux/outputs/can_dbc_frames.hpp"
#include "firmware/wire/can_bits.hpp"
#include "firmware/wire/can_frames.hpp"

namespace zerorate::linux_node {
namespace {

using dbc::Frame;
using dbc::Signal;

constexpr std::uint32_t kTurn = wire::kCanTurnEvery;
constexpr std::uint32_t kInputs = wire::kCanInputsEvery;
constexpr std::array kAxesFrames{
    Frame{"STATUS", 0, 1, "Sent after the three axes of the same sample.", dbc::kStatus},
    Frame{"X", 1, 1, "", dbc::kX}, Frame{"Y", 2, 1, "", dbc::kY}, Frame{"Z", 3, 1, "", dbc::kZ}};
constexpr std::array kSlowFrames{
    Frame{"INPUTS", wire::kCanInputsOffset, kInputs, "", dbc::kInputs},
    Frame{"TURN_X", wire::kCanTurnOffset, kTurn, "Angle since departure.", dbc::kTurnX},
    Frame{"TURN_Y", wire::kCanTurnOffset + 1, kTurn, "Angle since departure.", dbc::kTurnY},
    Frame{"TURN_Z", wire::kCanTurnOffset + 2, kTurn, "Angle since departure.", dbc::kTurnZ},
    Frame{"VERTICAL", wire::kCanVerticalOffset, kTurn,
          "Where the vertical is known; counter-clockwise seen from above.", dbc::kVertical},
    Frame{"UP", wire::kCanUpOffset, kTurn,
          "Where the vertical is known: the unit vector that points up, in the sensor's axes.",
          dbc::kUp},
    Frame{"ACCELERATION", wire::kCanAccelerationOffset, kTurn,
          "Of a node with an accelerometer: the specific force.", dbc::kAcceleration},
    Frame{"EXPLAINED_X", wire::kCanExplainedOffset, kInputs,
          "Where the sensor model follows inputs: what they explain of the bias.",
          dbc::kExplainedX},
    Frame{"EXPLAINED_Y", wire::kCanExplainedOffset + 1, kInputs, "As EXPLAINED_X.",
          dbc::kExplainedY},
    Frame{"EXPLAINED_Z", wire::kCanExplainedOffset + 2, kInputs, "As EXPLAINED_X.",
          dbc::kExplainedZ},
    Frame{"TURN_VERTICAL", wire::kCanVerticalTurnOffset, kTurn,
          "Where the vertical is known: angle since departure.", dbc::kTurnVertical}};
constexpr Frame kYawFrame{.name = "YAW",
                          .offset = 0,
                          .cycle = 1,
                          .comment = "Yaw rate of one sample.",
                          .signals = dbc::kYaw,
                          .is_protected = true};
constexpr Frame kFdFrame{.name = "FD",
                         .offset = 0,
                         .cycle = 1,
                         .comment = "Rates of one sample.",
                         .signals = dbc::kFd,
                         .is_fd = true,
                         .is_protected = true};

/// A frame of a sink.
struct Message {
  const Frame* frame;
  const CanSettings* sink;

  [[nodiscard]] unsigned id() const { return sink->id + frame->offset; }
};

void add_messages(const CanSettings& sink, std::vector<Message>& messages) {
  const auto add = [&](const Frame& frame) { messages.push_back({&frame, &sink}); };
  if (sink.layout == CanLayout::yaw) return add(kYawFrame);
  if (sink.layout == CanLayout::fd) {
    add(kFdFrame);
  } else {
    std::ranges::for_each(kAxesFrames, add);
  }
  std::ranges::for_each(kSlowFrames, add);
}

std::vector<Message> messages_of(std::span<const CanSettings> sinks) {
  std::vector<Message> messages;
  for (const CanSettings& sink : sinks) add_messages(sink, messages);
  std::map<unsigned, const Message*> by_id;
  std::map<std::string_view, const Message*> by_name;
  for (const Message& message : messages) {
    const bool is_new = by_id.emplace(message.id(), &message).second;
    if (!is_new || !by_name.emplace(message.frame->name, &message).second) {
      throw std::invalid_argument(fmt::format(
          "two CAN sinks of {} have the frame {} or the identifier {:#x} in common; a bus takes "
          "one sink with the layout axes or fd, and identifiers of its own for another with yaw",
          message.sink->interface, message.frame->name, message.id()));
    }
  }
  return messages;
}

std::string signal_line(const Signal& signal, unsigned start, std::string_view receivers) {
  return fmt::format(" SG_ {} : {}|{}@1{} ({},0) [{}|{}] \"{}\" {}\n", signal.name, start,
                     signal.bits, signal.is_signed ? '-' : '+', signal.factor, signal.lowest,
                     signal.highest, signal.unit, receivers);
}

std::string message_lines(const Message& message, std::string_view receivers) {
  std::string signals;
  unsigned start = 0;
  for (const Signal& signal : message.frame->signals) {
    if (!signal.name.empty()) signals += signal_line(signal, start, receivers);
    start += signal.bits;
  }
  return fmt::format("\nBO_ {} ZERORATE_{}: {} ZERORATE\n{}", message.id(), message.frame->name,
                     start / 8, signals);
}

std::string comment_lines(const Message& message) {
  std::string lines;
  if (!message.frame->comment.empty()) {
    lines += fmt::format("CM_ BO_ {} \"{}\";\n", message.id(), message.frame->comment);
  }
  for (const Signal& signal : message.frame->signals) {
    if (signal.comment.empty()) continue;
    lines += fmt::format("CM_ SG_ {} {} \"{}\";\n", message.id(), signal.name, signal.comment);
  }
  return lines;
}

/// Milliseconds from one frame to the next, as its attribute has them.
long cycle_ms(const Message& message, double rate_hz) {
  return std::lround(1e3 * message.sink->every * message.frame->cycle / rate_hz);
}

std::string attribute_lines(const Message& message, double rate_hz) {
  const unsigned id = message.id();
  std::string lines =
      fmt::format("BA_ \"GenMsgCycleTime\" BO_ {} {};\n", id, cycle_ms(message, rate_hz));
  if (message.frame->is_fd) lines += fmt::format("BA_ \"VFrameFormat\" BO_ {} 14;\n", id);
  if (message.frame->is_protected) {
    const bool is_both = message.sink->e2e.variant == wire::E2eVariant::both;
    lines += fmt::format("BA_ \"E2EProfile\" BO_ {} \"{}\";\nBA_ \"E2EDataId\" BO_ {} {};\n", id,
                         is_both ? "11A" : "11C", id, message.sink->e2e.data_id);
  }
  return lines;
}

std::string value_lines(const Message& message) {
  std::string lines;
  for (const Signal& signal : message.frame->signals) {
    std::string values{signal.values};
    if (signal.can_be_absent) {
      const std::int64_t content =
          signal.is_signed ? -std::int64_t{wire::can_not_available_signed(signal.bits)}
                           : std::int64_t{wire::can_not_available_unsigned(signal.bits)};
      values = fmt::format("{} \"not available\"", content);
    }
    if (values.empty()) continue;
    lines += fmt::format("VAL_ {} {} {} ;\n", message.id(), signal.name, values);
  }
  return lines;
}

constexpr std::string_view kDefinitions =
    "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 100000000;\n"
    "BA_DEF_ BO_ \"VFrameFormat\" ENUM "
    "\"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
    "\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
    "\"reserved\",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
    "BA_DEF_ BO_ \"E2EProfile\" STRING ;\n"
    "BA_DEF_ BO_ \"E2EDataId\" INT 0 65535;\n"
    "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
    "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n"
    "BA_DEF_DEF_ \"E2EProfile\" \"\";\n"
    "BA_DEF_DEF_ \"E2EDataId\" 0;\n";

void check_receiver(const std::string& name) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const bool is_name =
      !name.empty() && is_letter(name[0]) && name != "ZERORATE" &&
      std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
  if (!is_name) {
    throw std::invalid_argument(fmt::format(
        "receiver \"{}\": expected letters, digits and '_', no digit first, not ZERORATE", name));
  }
}

}  // namespace

std::string format_dbc(std::span<const CanSettings> sinks, const DbcFacts& facts) {
  std::ranges::for_each(facts.receivers, check_receiver);
  const std::vector<Message> messages = messages_of(sinks);
  const std::string receivers =
      facts.receivers.empty() ? "Vector__XXX" : fmt::format("{}", fmt::join(facts.receivers, ","));
  std::string text = "VERSION \"2\"\n\nNS_ :\n\nBS_:\n\nBU_: ZERORATE";
  for (const std::string& receiver : facts.receivers) text += " " + receiver;
  text += "\n";
  for (const Message& message : messages) text += message_lines(message, receivers);
  text += "\n";
  for (const Message& message : messages) text += comment_lines(message);
  text += kDefinitions;
  for (const Message& message : messages) text += attribute_lines(message, facts.rate_hz);
  for (const Message& message : messages) text += value_lines(message);
  return text;
}

}  // namespace zerorate::linux_node
