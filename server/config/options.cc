#include "server/config/options.h"

#include <cstdio>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "deploy/manual/build_facts.h"
#include "deploy/manual/command_parser.h"
#include "deploy/manual/man_page.h"
#include "server/config/option_kinds.h"

namespace latvox {
namespace {

using Rows = std::vector<OptionRow>;

// Returns the rows with their group on the first.
Rows Grouped(const char* group, Rows rows) {
  rows.front().group = group;
  return rows;
}

Rows LimitRows(Limits& limits) {
  return {
      AtLeastOne(Bytes("--max-mesh-bytes", limits.max_mesh_bytes, "Largest encoded mesh in bytes, 1073741824 or 1GiB")),
      AtLeastOne(Number("--max-triangles", limits.max_triangles, "Maximum number of triangles in a mesh")),
      AtLeastOne(Number("--max-vertices", limits.max_vertices, "Maximum number of vertices in a mesh")),
      AtLeastOne(Number("--max-jobs", limits.max_jobs, "Maximum number of jobs that run at once")),
      Number("--max-queued-jobs", limits.max_queued_jobs,
             "Maximum number of jobs that upload, wait for their turn, or wait for clients to read results"),
      AtLeastOne(Number("--max-jobs-per-client", limits.max_jobs_per_client,
                        "Maximum number of jobs of one client, running or queued")),
      AtLeastOne(
          Number("--max-visited-points", limits.max_visited_points,
                 "Maximum number of lattice points that one job visits, by an estimate that is mostly of its voxels")),
      Seconds("--max-job-seconds", 0.001, limits.max_job_time, "Maximum CPU time of one job, without decoding"),
      Bytes(
          "--mesh-store-bytes", limits.mesh_store_bytes,
          "Memory for meshes kept for later requests, encoded and, if there is room, decoded; 0 keeps none; at most an "
          "eighth of the memory budget"),
      AtLeastOne(Bytes("--max-message-bytes", limits.max_message_bytes, "Largest message that the server accepts")),
  };
}

// These rows continue the group of limits.
Rows MemoryRows(ServerOptions& server) {
  OptionRow memory =
      Bytes("--memory-budget", server.memory_bytes,
            "Memory of the process without its decoders, 4GiB for example; 0 takes three quarters of the available "
            "memory, or half of that with --exit-with-parent");
  memory.standard = "0";
  return {std::move(memory), Seconds("--stall-timeout", 1, server.stall_timeout,
                                     "Time after which a client is dropped that neither sends nor reads")};
}

Rows DecoderRows(ServerOptions& server) {
  DecoderOptions& decoder = server.decoder;
  decoder.program = "/proc/self/exe";
  OptionRow unconfined = Switch("--allow-unconfined-decoders", decoder.may_be_unconfined,
                                "Start even if the system does not allow confining decoder processes (seccomp)");
  unconfined.standard = "";
  return {NumberTo(64, "--decoder-processes", decoder.processes,
                   "Processes that decode meshes; 0 takes one per thread, 2 to 4"),
          Bytes("--decoder-memory", decoder.memory,
                "Maximum memory for decoding one mesh, for example 2GiB. 0: the memory that --max-triangles needs; all "
                "processes together get at most a third of the default of --memory-budget"),
          Seconds("--decoder-cpu-seconds", 0.001, decoder.cpu_time,
                  "Maximum CPU time for decoding one mesh; small meshes get less"),
          Switch("--decoders-on-demand", decoder.on_demand,
                 "Start the decoder processes with the first mesh that needs them, and thus start sooner"),
          Switch("--decode-always", server.decode_always,
                 "Decode the mesh of every request, even if it was decoded before"),
          std::move(unconfined)};
}

Rows ConnectionRows(ProgramOptions& options) {
  ServerOptions& server = options.server;
  return {
      Seconds("--keepalive-time", 1, server.keepalive_time, "Silence after which the server pings a client"),
      Seconds("--keepalive-timeout", 1, server.keepalive_timeout, "Time for a client to answer a ping"),
      Seconds("--max-connection-age", 0, server.max_connection_age,
              "Age at which a connection accepts no new calls; it closes when its calls have ended; 0 is no limit"),
      Seconds("--grace", 0, options.grace, "Time for running jobs to end after SIGTERM or SIGINT"),
  };
}

Rows AccessRows(AccessOptions& access) {
  return {
      File("--tls-cert", access.tls.certificate,
           "Certificate chain (PEM); it turns on TLS on all addresses except Unix sockets"),
      File("--tls-key", access.tls.key, "Key of --tls-cert (PEM, without a passphrase)"),
      File("--tls-client-ca", access.tls.client_ca,
           "Roots (PEM); each client must show a certificate that leads to one of them"),
      Switch("--insecure", access.insecure, "Serve other machines in plain text"),
      Switch(
          "--behind-proxy", access.behind_proxy,
          "Others reach this server only through a proxy such as haproxy, which limits each client by itself. So one "
          "address may send calls without the limit of a host, and a build without a guard may serve other machines"),
      File("--token-file", access.token_file,
           "File of bearer tokens, one per line: NAME TOKEN [max-jobs=N] [max-job-seconds=N] [max-mesh-bytes=N] "
           "[max-triangles=N]; "
           "TOKEN has 16 to 512 characters, or is sha256:HEX; without the file, everybody may call"),
  };
}

Rows WatchRows(ServerOptions& server) {
  return {Address("--health-listen", server.health_listen,
                  "Address that serves only grpc.health.v1, in plain text, for probes without TLS"),
          Address("--metrics-listen", server.metrics_listen,
                  "Address for Prometheus, IP:PORT; plain HTTP for everybody at /metrics")};
}

Rows LogRows(ProgramOptions& options) {
  return {Choice<LogLevel>("--log-level",
                           {{"debug", LogLevel::kDebug},
                            {"info", LogLevel::kInfo},
                            {"warning", LogLevel::kWarning},
                            {"error", LogLevel::kError},
                            {"off", LogLevel::kOff}},
                           options.log_level, "Lowest severity of lines in the log"),
          Choice<LogFormat>("--log-format", {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
                            options.log_format, "Format of the log's lines: key=value pairs, or JSON objects")};
}

Rows MainRows(ProgramOptions& options) {
  std::vector<std::pair<std::string, Simd>> simd;
  for (const auto& [value, name] : kSimdNames) simd.emplace_back(name, value);
  return {
      {.names = "--check-config",
       .target = &options.check_config,
       .help = "Print the settings in force and their sources, as a configuration file, and exit",
       .in_file = false},
      {.names = "--man", .target = &options.man, .help = "Print the manual page in troff and exit", .in_file = false},
      Texts("--listen", options.server.listen, "Address to serve, HOST:PORT or unix:PATH; may be repeated"),
      NumberTo(1024, "--threads", options.server.threads,
               "Threads that compute; 0 takes one per core, in a container as many as it may use"),
      Choice("--simd", simd, options.simd, "Instruction set of the kernels; results do not depend on it")};
}

std::string CheckPositive(const std::string& text) {
  int number = 0;
  if (absl::SimpleAtoi(text, &number) && number > 0) return "";
  return absl::StrCat("\"", text, "\" is not a whole number above 0");
}

// Rows for the program that starts a private server.
Rows ParentRows(ProgramOptions& options) {
  return {Switch("--exit-with-parent", options.exit_with_parent,
                 "Stop when the parent process ends, and leave it half of the memory"),
          {.names = "--parent-pid",
           .target = &options.parent_pid,
           .help = "Number of the parent process, which may end before latvoxd can ask for it",
           .checks = {{CheckPositive, "above 0"}},
           .in_file = false}};
}

void AddOptions(CommandParser& parser, ProgramOptions& options) {
  options.server.build = FactsOfThisBuild();
  parser.SetVersion(VersionPage("latvoxd", options.server.build));
  AddConfigurationFile(parser);
  parser.Add(MainRows(options));
  parser.Add(Grouped("Limits", LimitRows(options.server.limits)));
  parser.Add(MemoryRows(options.server));
  parser.Add(Grouped("Decoding", DecoderRows(options.server)));
  parser.Add(Grouped("Connections", ConnectionRows(options)));
  parser.Add(Grouped("Access", AccessRows(options.server.access)));
  parser.Add(Grouped("Health and metrics", WatchRows(options.server)));
  parser.Add(Grouped("Log", LogRows(options)));
  parser.Add(Grouped("Private server", ParentRows(options)));
  parser.SetFooter(
      "Each option is also an environment variable and a key of the configuration file:\n"
      "--max-jobs, LATVOX_MAX_JOBS, max-jobs. --check-config, --man and --parent-pid are options only.\n");
}

// The parser of the command line, and the configuration that it fills.
struct Parser {
  Configuration configuration;
  CommandParser parser{"Voxelize triangle meshes on lattices as a gRPC service", "latvoxd"};

  Parser() { AddOptions(parser, configuration.options); }

  // Returns the page of --help or --version, if these are given. Throws UsageError.
  std::string Parse(int argc, const char* const* argv) {
    std::string page = parser.Parse({argv + 1, argv + argc});
    if (!page.empty()) return page;
    ServerOptions& server = configuration.options.server;
    server.shares_memory = configuration.options.exit_with_parent;
    // A single client's job must not wait for other programs.
    if (configuration.options.exit_with_parent) server.bulk_niceness = 0;
    configuration.file = parser.file();
    configuration.settings = SettingsOf(parser.States(), configuration.file);
    configuration.misspelled = MisspelledVariables(parser.States());
    return "";
  }
};

std::string ManPageOf(CommandFacts facts) {
  facts.description = "voxelizes triangle meshes on lattices as a gRPC service";
  ManPage page;
  page.section = 8;
  page.version = LATVOX_VERSION;
  page.before = {
      {"DESCRIPTION",
       "latvoxd serves the protocol latvox.v1 until SIGTERM or SIGINT. The first signal lets running jobs\n"
       "end.\n"
       "\n"
       "Sockets that systemd passes by LISTEN_FDS take the place of --listen.\n"
       "\n"
       "Each option is also an environment variable and a key of the configuration file, except\n"
       "--check-config, --man and --parent-pid. The command line overrides the environment, and the\n"
       "environment overrides the file.\n"
       "\n"
       "The file is read again when it changes and at SIGHUP. Its log level applies at once, other settings\n"
       "at the next start. Certificates and tokens are read again in the same way, and apply at once.\n"}};
  page.after = {{"EXIT STATUS", "0 after SIGTERM or SIGINT; 1 latvoxd could not serve; 2 wrong usage"},
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
    std::string page = parser.Parse(argc, argv);
    if (parser.configuration.options.man) page = ManPageOf(parser.parser.Describe());
    if (page.empty()) return parser.configuration;
    std::fputs(page.c_str(), stdout);
    return 0;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "latvoxd: %s\n", error.what());
    constexpr int kWrongUsage = 2;
    return kWrongUsage;
  }
}

absl::StatusOr<Configuration> ReadOptionsAgain(int argc, const char* const* argv) {
  Parser parser;
  try {
    parser.Parse(argc, argv);
  } catch (const UsageError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  return parser.configuration;
}

}  // namespace latvox
