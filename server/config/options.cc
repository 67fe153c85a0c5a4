#include "server/config/options.h"

#include <cstdio>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "deploy/manual/command_parser.h"
#include "deploy/manual/man_page.h"
#include "server/config/option_kinds.h"

namespace latvox {
namespace {

using Rows = std::vector<OptionRow>;

// Sets the group of the first row.
Rows Grouped(const char* group, Rows rows) {
  rows.front().group = group;
  return rows;
}

Rows LimitRows(Limits& limits) {
  return {
      AtLeastOne(Bytes("--max-mesh-bytes", limits.max_mesh_bytes, "Largest encoded mesh, as 1073741824 or 1GiB")),
      AtLeastOne(Number("--max-triangles", limits.max_triangles, "Most triangles in a mesh")),
      AtLeastOne(Number("--max-vertices", limits.max_vertices, "Most points in a mesh")),
      AtLeastOne(Number("--max-jobs", limits.max_jobs, "Most jobs at work at once")),
      Number("--max-queued-jobs", limits.max_queued_jobs,
             "Most jobs that send their input, wait for their turn, or wait for their clients to take results"),
      AtLeastOne(
          Number("--max-jobs-per-client", limits.max_jobs_per_client, "Most jobs of one client, at work or queued")),
      AtLeastOne(Number("--max-visited-points", limits.max_visited_points,
                        "Most lattice points that one job looks at, by an estimate: mostly of its voxels")),
      Bytes("--mesh-store-bytes", limits.mesh_store_bytes,
            "Meshes that are kept for later requests, encoded and, as far as there is room, decoded; at most an "
            "eighth of the memory budget. 0: none"),
      AtLeastOne(Bytes("--max-message-bytes", limits.max_message_bytes, "Largest message that is received")),
  };
}

// These belong to the group of limits, too.
Rows MemoryRows(ServerOptions& server) {
  OptionRow memory =
      Bytes("--memory-budget", server.memory_bytes,
            "Memory of the process but for its decoders, as 4GiB; 0: three quarters of what there is, or, with "
            "--exit-with-parent, half of that");
  memory.standard = "0";
  return {std::move(memory), Seconds("--stall-timeout", 1, server.stall_timeout,
                                     "Time after which a client that neither sends nor takes anything is given up")};
}

Rows DecoderRows(ServerOptions& server) {
  DecoderOptions& decoder = server.decoder;
  decoder.program = "/proc/self/exe";
  OptionRow unconfined = Switch("--allow-unconfined-decoders", decoder.may_be_unconfined,
                                "Start also where the system does not allow to confine decoder processes (seccomp)");
  unconfined.standard = "";
  return {NumberTo(64, "--decoder-processes", decoder.processes,
                   "Processes that decode meshes; 0: one for each thread, at most 4"),
          Bytes("--decoder-memory", decoder.memory,
                "Most memory that decoding one mesh may take, as 2GiB; 0: what --max-triangles needs, but for all "
                "processes at most a third of the default of --memory-budget"),
          Seconds("--decoder-cpu-seconds", 0.001, decoder.cpu_time, "Most CPU time that decoding one mesh may take"),
          Switch("--decode-always", server.decode_always,
                 "Decode a mesh for each request, also one that was asked for before"),
          std::move(unconfined)};
}

Rows ConnectionRows(ProgramOptions& options) {
  ServerOptions& server = options.server;
  return {
      Seconds("--keepalive-time", 1, server.keepalive_time, "Silence after which a client is pinged"),
      Seconds("--keepalive-timeout", 1, server.keepalive_timeout, "Time a client has to answer a ping"),
      Seconds("--max-connection-age", 0, server.max_connection_age,
              "Age at which a connection takes no new calls, and closes once those it has have ended; 0: none"),
      Seconds("--grace", 0, options.grace, "Time that running jobs get to end after SIGTERM or SIGINT"),
  };
}

Rows AccessRows(AccessOptions& access) {
  return {
      File("--tls-cert", access.tls.certificate, "Certificate chain (PEM): TLS on all addresses but Unix sockets"),
      File("--tls-key", access.tls.key, "Key of the certificate (PEM, without a passphrase)"),
      File("--tls-client-ca", access.tls.client_ca,
           "Roots (PEM): clients have to show a certificate that leads to one of them"),
      Switch("--insecure", access.insecure, "Serve others than this machine in plain text"),
      File("--token-file", access.token_file,
           "File of bearer tokens, a line each: NAME TOKEN [max-jobs=N] [max-mesh-bytes=N] [max-triangles=N]; "
           "TOKEN has 16 to 512 characters, or is sha256:HEX. Without it, everybody may call"),
  };
}

Rows WatchRows(ServerOptions& server) {
  return {Address("--health-listen", server.health_listen,
                  "Address for grpc.health.v1 alone, in plain text, for probes that know no TLS"),
          Address("--metrics-listen", server.metrics_listen,
                  "Address for Prometheus, HOST:PORT with an IP address: plain HTTP, for everybody; path /metrics")};
}

Rows LogRows(ProgramOptions& options) {
  return {Choice<LogLevel>("--log-level",
                           {{"debug", LogLevel::kDebug},
                            {"info", LogLevel::kInfo},
                            {"warning", LogLevel::kWarning},
                            {"error", LogLevel::kError},
                            {"off", LogLevel::kOff}},
                           options.log_level, "Least severe lines of the log that are written"),
          Choice<LogFormat>("--log-format", {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
                            options.log_format, "Lines of the log: key=value pairs, or JSON objects")};
}

Rows MainRows(ProgramOptions& options) {
  std::vector<std::pair<std::string, Simd>> simd;
  for (const auto& [value, name] : kSimdNames) simd.emplace_back(name, value);
  return {{.names = "--check-config",
           .target = &options.check_config,
           .help = "Print what is in force and where it came from, as a configuration file, and exit",
           .in_file = false},
          {.names = "--man",
           .target = &options.man,
           .help = "Print the manual page, as troff reads it, and exit",
           .in_file = false},
          Texts("--listen", options.server.listen, "Address, HOST:PORT or unix:PATH; may be repeated"),
          NumberTo(1024, "--threads", options.server.threads,
                   "Threads that compute; 0: one for each core that there is, in a container as many as it may use"),
          Choice("--simd", simd, options.simd, "Instructions that the kernels may use; results are the same")};
}

std::string CheckPositive(const std::string& text) {
  int number = 0;
  if (absl::SimpleAtoi(text, &number) && number > 0) return "";
  return absl::StrCat("\"", text, "\" is not a whole number above 0");
}

// For the program that starts a private server.
Rows ParentRows(ProgramOptions& options) {
  return {Switch("--exit-with-parent", options.exit_with_parent,
                 "Stop when the process that started this one ends, and leave it half of the memory"),
          {.names = "--parent-pid",
           .target = &options.parent_pid,
           .help = "That process, for --exit-with-parent: it may end before this one can ask which it is",
           .checks = {{CheckPositive, "POSITIVE"}},
           .in_file = false}};
}

void AddOptions(CommandParser& parser, ProgramOptions& options) {
  parser.SetVersion("latvoxd " LATVOX_VERSION);
  AddConfigurationFile(parser);
  parser.Add(MainRows(options));
  parser.Add(Grouped("Limits", LimitRows(options.server.limits)));
  parser.Add(MemoryRows(options.server));
  parser.Add(Grouped("Decoding", DecoderRows(options.server)));
  parser.Add(Grouped("Connections", ConnectionRows(options)));
  parser.Add(Grouped("Access", AccessRows(options.server.access)));
  parser.Add(Grouped("Health and metrics", WatchRows(options.server)));
  parser.Add(Grouped("Log", LogRows(options)));
  parser.Add(Grouped("Options", ParentRows(options)));
}

// Reads the command line, and holds the results.
struct Parser {
  Configuration configuration;
  CommandParser parser{"latvoxd: voxelizes triangle meshes on lattices, as a gRPC service", "latvoxd"};

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
    std::string page = parser.Parse(argc, argv);
    if (parser.configuration.options.man) page = ManPageOf(parser.parser.Describe());
    if (page.empty()) return parser.configuration;
    std::fputs(page.c_str(), stdout);
    return 0;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s\nRun with --help for more information.\n", error.what());
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
