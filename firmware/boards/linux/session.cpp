#include "firmware/boards/linux/session.hpp"

#include <cerrno>
#include <ctime>
#include <fstream>
#include <string>
#include <system_error>

namespace zerorate::linux_node {

app::Session read_boot_id() {
  constexpr const char* kFile = "/proc/sys/kernel/random/boot_id";
  app::Session boot{};
  std::ifstream file{kFile};
  if (!file.read(boot.data(), boot.size())) {
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), kFile);
  }
  return boot;
}

app::SnapshotTime time_in(const app::Session& session) {
  return {.session = session, .utc_s = std::time(nullptr)};
}

std::uint32_t sensor_id(const GyroSettings& gyro) {
  return app::sensor_id(gyro.chip + '\n' + gyro.device + '\n' + std::to_string(gyro.address));
}

}  // namespace zerorate::linux_node
