#include "server/config/options.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <utility>

#include "deploy/manual/man_page.h"
#include "server/config/option_kinds.h"

namespace latvox {
namespace {

void AddLimits(CLI::App& app, Limits& limits) {
  app.option_defaults()->group("Limits");
  AddBytes(app, "--max-mesh-bytes", limits.max_mesh_bytes, "Largest encoded mesh, as 1073741824 or 1GiB");
  Add(app, "--max-triangles", limits.max_triangles, "Most triangles in a mesh")->check(AtLeastOne());
  Add(app, "--max-vertices", limits.max_vertices, "Most points in a mesh")->check(AtLeastOne());
  Add(app, "--max-jobs", limits.max_jobs, "Most jobs at work at once")->check(AtLeastOne());
  Add(app, "--max-queued-jobs", limits.max_queued_jobs,
      "Most jobs that send their input, wait for their turn, or wait for their clients to take results");
  Add(app, "--max-jobs-per-client", limits.max_jobs_per_client, "Most jobs of one client, at work or queued")
      ->check(AtLeastOne());
  Add(app, "--max-visited-points", limits.max_visited_points,
      "Most lattice points that one job looks at, by an estimate: mostly of its voxels")
      ->check(AtLeastOne());
  TakeBytes(Add(app, "--mesh-store-bytes", limits.mesh_store_bytes,
                "Meshes that are kept for later requests, encoded and, as far as there is room, decoded; at most an "
                "eighth of the memory budget. 0: none"));
  AddBytes(app, "--max-message-bytes", limits.max_message_bytes, "Largest message that is received");
}

void AddAccess(CLI::App& app, AccessOptions& access) {
  app.option_defaults()->group("Access");
  Add(app, "--tls-cert", access.tls.certificate, "Certificate chain (PEM): TLS on all addresses but Unix sockets")
      ->type_name("FILE");
  Add(app, "--tls-key", access.tls.key, "Key of the certificate (PEM, without a passphrase)")->type_name("FILE");
  Add(app, "--tls-client-ca", access.tls.client_ca,
      "Roots (PEM): clients have to show a certificate that leads to one of them")
      ->type_name("FILE");
  AddSwitch(app, "--insecure", access.insecure, "Serve others than this machine in plain text");
  Add(app, "--token-file", access.token_file,
      "File of bearer tokens, a line each: NAME TOKEN [max-jobs=N] [max-mesh-bytes=N] [max-triangles=N]; "
      "TOKEN has 16 to 512 characters, or is sha256:HEX. Without it, everybody may call")
      ->type_name("FILE");
}

void AddLog(CLI::App& app, ProgramOptions& options) {
  app.option_defaults()->group("Log");
  AddChoice<LogLevel>(app, "--log-level",
                      {{"debug", LogLevel::kDebug},
                       {"info", LogLevel::kInfo},
                       {"warning", LogLevel::kWarning},
                       {"error", LogLevel::kError},
                       {"off", LogLevel::kOff}},
                      options.log_level, "Least severe lines of the log that are written");
  AddChoice<LogFormat>(app, "--log-format", {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
                       options.log_format, "Lines of the log: key=value pairs, or JSON objects");
}

void AddDecoder(CLI::App& app, ServerOptions& server) {
  DecoderOptions& decoder = server.decoder;
  app.option_defaults()->group("Decoding");
  decoder.program = "/proc/self/exe";
  Add(app, "--decoder-processes", decoder.processes, "Processes that decode meshes; 0: one for each thread, at most 4")
      ->check(CLI::Range(0, 64));
  TakeBytes(Add(app, "--decoder-memory", decoder.memory,
                "Most memory that decoding one mesh may take, as 2GiB; 0: what --max-triangles needs, but for all "
                "processes at most a third of the default of --memory-budget"));
  AddSeconds(app, "--decoder-cpu-seconds", 0.001, decoder.cpu_time, "Most CPU time that decoding one mesh may take");
  AddSwitch(app, "--decode-always", server.decode_always,
            "Decode a mesh for each request, also one that was asked for before");
  app.add_flag("--allow-unconfined-decoders", decoder.may_be_unconfined,
               "Start also where the system does not allow to confine decoder processes (seccomp)")
      ->envname("LATVOX_ALLOW_UNCONFINED_DECODERS");
}

void AddOptions(CLI::App& app, ProgramOptions& options) {
  app.set_version_flag("--version", "latvoxd " LATVOX_VERSION);
  AddConfigurationFile(app);
  app.add_flag("--check-config", options.check_config,
               "Print what is in force and where it came from, as a configuration file, and exit")
      ->configurable(false);
  app.add_flag("--man", options.man, "Print the manual page, as troff reads it, and exit")->configurable(false);
  Add(app, "--listen", options.server.listen, "Address, HOST:PORT or unix:PATH; may be repeated")->delimiter(',');
  Add(app, "--threads", options.server.threads,
      "Threads that compute; 0: one for each core that there is, in a container as many as it may use")
      ->check(CLI::Range(0, 1024));
  std::vector<std::pair<std::string, Simd>> simd;
  for (const auto& [value, name] : kSimdNames) simd.emplace_back(name, value);
  AddChoice(app, "--simd", simd, options.simd, "Instructions that the kernels may use; results are the same");
  AddLimits(app, options.server.limits);
  TakeBytes(Add(app, "--memory-budget", options.server.memory_bytes,
                "Memory of the process but for its decoders, as 4GiB; 0: three quarters of what there is, or, with "
                "--exit-with-parent, half of that"))
      ->default_str("0");
  AddSeconds(app, "--stall-timeout", 1, options.server.stall_timeout,
             "Time after which a client that neither sends nor takes anything is given up");
  AddDecoder(app, options.server);
  app.option_defaults()->group("Connections");
  AddSeconds(app, "--keepalive-time", 1, options.server.keepalive_time, "Silence after which a client is pinged");
  AddSeconds(app, "--keepalive-timeout", 1, options.server.keepalive_timeout, "Time a client has to answer a ping");
  AddSeconds(app, "--max-connection-age", 0, options.server.max_connection_age,
             "Age at which a connection takes no new calls, and closes once those it has have ended; 0: none");
  AddSeconds(app, "--grace", 0, options.grace, "Time that running jobs get to end after SIGTERM or SIGINT");
  AddAccess(app, options.server.access);
  app.option_defaults()->group("Health and metrics");
  Add(app, "--health-listen", options.server.health_listen,
      "Address for grpc.health.v1 alone, in plain text, for probes that know no TLS")
      ->type_name("ADDRESS");
  Add(app, "--metrics-listen", options.server.metrics_listen,
      "Address for Prometheus, HOST:PORT with an IP address: plain HTTP, for everybody; path /metrics")
      ->type_name("ADDRESS");
  AddLog(app, options);
  app.option_defaults()->group("Options");
  AddSwitch(app, "--exit-with-parent", options.exit_with_parent,
            "Stop when the process that started this one ends, and leave it half of the memory");
  app.add_option("--parent-pid", options.parent_pid,
                 "That process, for --exit-with-parent: it may end before this one can ask which it is")
      ->check(CLI::PositiveNumber)
      ->configurable(false);
}

// A CLI::App and what it fills.
struct Parser {
  Configuration configuration;
  CLI::App app{"latvoxd: voxelizes triangle meshes on lattices, as a gRPC service", "latvoxd"};

  Parser() { AddOptions(app, configuration.options); }

  // Throws CLI::ParseError, also for --help and --version.
  void Parse(int argc, const char* const* argv) {
    app.parse(argc, argv);
    configuration.options.server.shares_memory = configuration.options.exit_with_parent;
    // A single client's job is not to wait for other programs.
    if (configuration.options.exit_with_parent) configuration.options.server.bulk_niceness = 0;
    configuration.settings = SettingsOf(app);
    configuration.misspelt = MisspeltVariables(app);
    configuration.file = app.get_config_ptr()->as<std::string>();
  }
};

std::string ManPageOf(const CLI::App& app) {
  CommandFacts facts = Describe(app);
  facts.description = "voxelizes triangle meshes on lattices, as a gRPC service";
  ManPage page;
  page.section = 8;
  page.version = LATVOX_VERSION;
  page.before = {{"DESCRIPTION",
                  "latvoxd serves the protocol latvox.v1 until SIGTERM or SIGINT, of which the first lets running\n"
                  "jobs end. Each option may also be an environment variable, or a key of the configuration file: the\n"
                  "command line wins over the environment, and that over the file. A file that changes is read again,\n"
                  "and also at SIGHUP: its log level holds at once, the rest at the next start. Certificates and\n"
                  "tokens are read again likewise.\n"}};
  page.after = {{"EXIT STATUS", "0 after SIGTERM or SIGINT; 1 it could not serve; 2 wrong usage"},
                {"EXAMPLES",
                 "  latvoxd --listen 127.0.0.1:50151\n"
                 "  latvoxd --listen 0.0.0.0:50151 --tls-cert certificate.pem --tls-key key.pem --token-file tokens\n"
                 "  latvoxd --config latvoxd.toml --check-config\n"}};
  page.see_also = {"latvox(1)"};
  return ToMan(facts, page);
}

}  // namespace

std::variant<Configuration, int> ParseOptions(int argc, const char* const* argv) {
  Parser parser;
  try {
    parser.Parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    constexpr int kWrongUsage = 2;
    return parser.app.exit(error) == 0 ? 0 : kWrongUsage;
  }
  if (parser.configuration.options.man) {
    std::fputs(ManPageOf(parser.app).c_str(), stdout);
    return 0;
  }
  return parser.configuration;
}

absl::StatusOr<Configuration> ReadOptionsAgain(int argc, const char* const* argv) {
  Parser parser;
  try {
    parser.Parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  return parser.configuration;
}

}  // namespace latvox
