#include "tests/faults/records.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "absl/time/clock.h"

namespace latvox::faults {

Records::Records(const std::string& path) : file_(open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644)) {
  if (file_ >= 0) return;
  std::perror(path.c_str());
  std::exit(2);
}

void Records::Write(const Record& record) const {
  const nlohmann::json line{{"at", absl::ToDoubleSeconds(absl::Now() - absl::UnixEpoch())},
                            {"client", record.client},
                            {"life", record.life},
                            {"call", record.call},
                            {"role", record.role},
                            {"job", record.job},
                            {"accepted", record.accepted},
                            {"outcome", record.outcome},
                            {"detail", record.detail},
                            {"ms", record.ms},
                            {"wait_ms", record.wait_ms},
                            {"resumed", record.resumed}};
  const std::string text = line.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
  if (write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) std::_Exit(3);
}

}  // namespace latvox::faults
