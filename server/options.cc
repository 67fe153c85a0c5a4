#include "server/options.h"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <istream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace latvox {
namespace {

// --max-jobs -> LATVOX_MAX_JOBS
std::string EnvironmentName(absl::string_view flag) {
  return absl::StrCat("LATVOX_", absl::AsciiStrToUpper(absl::StrReplaceAll(flag.substr(2), {{"-", "_"}})));
}

// CLI11 lets the file win over the environment.
class ConfigBelowEnvironment : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> settings = CLI::ConfigTOML::from_config(input);
    std::erase_if(settings, [](const CLI::ConfigItem& item) {
      const char* value = std::getenv(EnvironmentName(absl::StrCat("--", item.name)).c_str());
      return value != nullptr && *value != '\0';
    });
    return settings;
  }
};

template <class T>
CLI::Option* Add(CLI::App& app, const std::string& flag, T& value, const std::string& description) {
  return app.add_option(flag, value, description)->envname(EnvironmentName(flag))->capture_default_str();
}

const CLI::Validator& AtLeastOne() {
  static const auto& validator = *new CLI::Validator(
      [](std::string& value) { return value == "0" ? std::string("0 is below 1") : std::string(); }, "of at least 1");
  return validator;
}

void AddBytes(CLI::App& app, const std::string& flag, uint64_t& value, const std::string& description) {
  Add(app, flag, value, description)->transform(CLI::AsSizeValue(false))->check(AtLeastOne());
}

void AddSeconds(CLI::App& app, const std::string& flag, double least, absl::Duration& value,
                const std::string& description) {
  constexpr double kMost = 86400;
  app.add_option_function<double>(
         flag, [&value](double seconds) { value = absl::Seconds(seconds); }, description)
      ->envname(EnvironmentName(flag))
      ->default_str(absl::StrCat(absl::ToDoubleSeconds(value)))
      ->type_name("SECONDS")
      ->check(CLI::Range(least, kMost));
}

void AddLimits(CLI::App& app, Limits& limits) {
  AddBytes(app, "--max-mesh-bytes", limits.max_mesh_bytes, "Largest encoded mesh, as 1073741824 or 1GiB");
  Add(app, "--max-triangles", limits.max_triangles, "Most triangles in a mesh")->check(AtLeastOne());
  Add(app, "--max-vertices", limits.max_vertices, "Most points in a mesh")->check(AtLeastOne());
  Add(app, "--max-jobs", limits.max_jobs, "Most jobs at work at once")->check(AtLeastOne());
  Add(app, "--max-queued-jobs", limits.max_queued_jobs, "Most jobs that send their input or wait for their turn");
  Add(app, "--max-jobs-per-client", limits.max_jobs_per_client, "Most jobs of one client, at work or queued")
      ->check(AtLeastOne());
  Add(app, "--max-voxels", limits.max_voxels, "Most voxels in one job, estimated from the area of its surface")
      ->check(AtLeastOne());
  AddBytes(app, "--mesh-store-bytes", limits.mesh_store_bytes,
           "Encoded meshes that are kept for later requests, at most an eighth of the memory budget");
  AddBytes(app, "--max-message-bytes", limits.max_message_bytes, "Largest message that is received");
}

void AddOptions(CLI::App& app, ProgramOptions& options) {
  app.set_version_flag("--version", "latvoxd " LATVOX_VERSION);
  app.set_config("--config", "", "Configuration file (TOML) with the options' long names as keys")
      ->envname("LATVOX_CONFIG");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<ConfigBelowEnvironment>());
  Add(app, "--listen", options.server.listen, "Address, HOST:PORT or unix:PATH; may be repeated")->delimiter(',');
  Add(app, "--threads", options.server.threads, "Threads that compute; 0: one for each core")
      ->check(CLI::Range(0, 1024));
  app.add_option_function<std::string>(
         "--simd", [&options](const std::string& name) { options.simd = *SimdNamed(name); },
         "Instructions that the kernels may use; results are the same")
      ->envname("LATVOX_SIMD")
      ->default_str("best")
      ->check(CLI::IsMember(std::vector<std::string>{"scalar", "avx2", "avx512", "best"}));
  AddLimits(app, options.server.limits);
  app.add_option("--memory-budget", options.server.memory_bytes,
                 "Memory of the process but for its decoders, as 4GiB; 0: three quarters of what there is")
      ->envname("LATVOX_MEMORY_BUDGET")
      ->transform(CLI::AsSizeValue(false))
      ->default_str("0");
  AddSeconds(app, "--stall-timeout", 1, options.server.stall_timeout,
             "Time after which a client that neither sends nor takes anything is given up");
  AddSeconds(app, "--keepalive-time", 1, options.server.keepalive_time, "Silence after which a client is pinged");
  AddSeconds(app, "--keepalive-timeout", 1, options.server.keepalive_timeout, "Time a client has to answer a ping");
  AddSeconds(app, "--grace", 0, options.grace, "Time that running jobs get to end after SIGTERM or SIGINT");
  const std::map<std::string, LogLevel> levels = {{"debug", LogLevel::kDebug},
                                                  {"info", LogLevel::kInfo},
                                                  {"warning", LogLevel::kWarning},
                                                  {"error", LogLevel::kError},
                                                  {"off", LogLevel::kOff}};
  app.add_option_function<std::string>(
         "--log-level", [levels, &options](const std::string& name) { options.log_level = levels.at(name); },
         "Least severe lines of the log that are written")
      ->envname("LATVOX_LOG_LEVEL")
      ->default_str("info")
      ->check(CLI::IsMember(std::vector<std::string>{"debug", "info", "warning", "error", "off"}));
  app.add_flag("--exit-with-parent", options.exit_with_parent, "Stop when the process that started this one ends")
      ->envname("LATVOX_EXIT_WITH_PARENT");
}

}  // namespace

std::variant<ProgramOptions, int> ParseOptions(int argc, const char* const* argv) {
  ProgramOptions options;
  CLI::App app("latvoxd: voxelizes triangle meshes on lattices, as a gRPC service", "latvoxd");
  AddOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    constexpr int kWrongUsage = 2;
    return app.exit(error) == 0 ? 0 : kWrongUsage;
  }
  return options;
}

}  // namespace latvox
