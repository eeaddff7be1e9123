#include "firmware/boards/linux/session.hpp"

#include <cerrno>
#include <ctime>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/base/crc32.hpp"

namespace zerorate::linux_node {

app::Session read_boot_id() {
  constexpr const char* kFile = "/proc/sys/kernel/random/boot_id";
  app::Session boot{};
  std::ifstream file{kFile};
  if (!file.read(boot.data(), boot.size())) {
    throw std::system_error(errno, std::generic_category(), kFile);
  }
  return boot;
}

app::SnapshotTime time_in(const app::Session& session) {
  return {.session = session, .utc_s = std::time(nullptr)};
}

std::uint32_t sensor_id(const GyroSettings& gyro) {
  const std::string wiring = gyro.chip + '\n' + gyro.device + '\n' + std::to_string(gyro.address);
  return core::crc32(std::vector<std::uint8_t>{wiring.begin(), wiring.end()});
}

}  // namespace zerorate::linux_node
