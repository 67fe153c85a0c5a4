#include "client/tool/cli/pages.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "deploy/manual/man_page.h"

namespace latvox::client {
namespace {

constexpr char kExitStatus[] =
    "0 done; 1 other; 2 wrong usage; 3 bad input; 4 server not reached; 5 refused; 6 cancelled or timed out";

// Examples of each command, which the tests run one after the other in a directory with bunny.obj.
constexpr std::pair<const char*, const char*> kExamples[] = {
    {"voxelize",
     "Examples:\n"
     "  latvox voxelize bunny.obj --lattice bcc --resolution 128 -o bunny.vdb -o bunny.png\n"
     "  latvox voxelize bunny.obj --voxel-size 0.05 --origin 0,0,0 -o bunny.csv --verify\n"
     "  latvox voxelize - --up-axis y --scale 10 --resolution 64 --weld-report -o bunny.glb < bunny.obj\n"},
    {"batch",
     "Examples:\n"
     "  echo '{\"mesh\": \"bunny.obj\", \"lattice\": \"fcc\", \"resolution\": 64}' > jobs.jsonl\n"
     "  latvox batch jobs.jsonl --out voxels --resume\n"},
    {"pixelize",
     "Examples:\n"
     "  echo '0,0 4,9 8,0 -1,6 9,6 z' > star.txt\n"
     "  latvox pixelize star.txt --lattice hexagonal --resolution 40 -o star.csv -o star.png\n"},
    {"encode",
     "Examples:\n"
     "  latvox encode bunny.obj -o bunny.drc\n"},
    {"merge",
     "Examples:\n"
     "  for i in 0 1; do latvox voxelize bunny.obj --resolution 64 --shard $i/2 -o part$i.vdb; done\n"
     "  latvox merge part0.vdb part1.vdb -o whole.vdb\n"},
    {"render",
     "Examples:\n"
     "  latvox render bunny.vdb --view -60,10 -o side.png\n"},
    {"slice",
     "Examples:\n"
     "  latvox slice bunny.vdb --axis z --index 40 -o slice.png\n"
     "  latvox voxelize bunny.obj --resolution 40 --band 3v --signed -o band.vdb\n"
     "  latvox slice band.vdb --axis z --index 10 -o distance.png -o distance.csv\n"},
    {"view",
     "Examples:\n"
     "  latvox view bunny.vdb -o bunny.html\n"},
    {"compare",
     "Exit status: 0 equal; 1 different; otherwise as of all commands\n"
     "\n"
     "Examples:\n"
     "  latvox compare bunny.vdb bunny.vdb\n"},
    {"info", "Examples:\n  latvox info bunny.vdb\n"},
    {"completions",
     "Examples:\n"
     "  source <(latvox completions bash)\n"},
    {"man", "Examples:\n  latvox man > latvox.1\n"},
};

}  // namespace

std::string Introduction() {
  return "latvox turns triangle meshes into sparse voxels, exactly, on the Cartesian, BCC, FCC, hexagonal or any "
         "other\n"
         "three-dimensional lattice. It starts a server for the call by itself; nothing has to run.\n"
         "\n"
         "A mesh to begin with:\n"
         "  cp /usr/share/glmark2/models/bunny.obj .\n"
         "Its voxels on the body-centred lattice, 128 along its longest side, as an OpenVDB grid and as a picture:\n"
         "  latvox voxelize bunny.obj --lattice bcc --resolution 128 -o bunny.vdb -o bunny.png\n"
         "What the grid holds:\n"
         "  latvox info bunny.vdb\n"
         "Cubes of a given size as a table of coordinates, with proof that no path leaks through and no voxel is "
         "idle:\n"
         "  latvox voxelize bunny.obj --voxel-size 0.05 -o bunny.csv --verify\n"
         "\n"
         "Meshes: .drc .obj .ply .stl .glb .gltf .3mf, or - for standard input. The extension of -o says what is "
         "written.\n"
         "All commands: latvox --help. Options of one: latvox voxelize --help. Everything: man latvox.\n";
}

std::string Footer() {
  return absl::StrCat(
      "Options of a command: latvox COMMAND --help. An introduction: latvox alone.\nExit status: ", kExitStatus, "\n");
}

std::string FooterOf(const std::string& command) {
  for (const auto& [name, examples] : kExamples) {
    if (name == command) return examples;
  }
  return "";
}

std::string ManPageOf(CommandFacts facts) {
  facts.description = "exact sparse voxels of triangle meshes on any lattice";
  ManPage page;
  page.version = LATVOX_VERSION;
  page.before = {{"DESCRIPTION", Introduction()}};
  page.after = {
      {"EXIT STATUS",
       absl::StrCat(kExitStatus, ".\nOne line on standard error says what failed, of which field, and which limit.\n")},
      {"ENVIRONMENT",
       "NO_COLOR, if it is not empty, keeps colours off terminals; what is no terminal gets none.\n"
       "LATVOX_LATVOXD is the program that is started as a private server, in place of the latvoxd beside latvox.\n"
       "LATVOX_THREADS, LATVOX_MEMORY_BUDGET and the others of latvoxd(8) hold for it as well, but for those of\n"
       "its configuration file, addresses, TLS and tokens. XDG_RUNTIME_DIR is where its socket is, else /tmp.\n"
       "JOB_COMPLETION_INDEX with LATVOX_WORKER_COUNT, or SLURM_ARRAY_TASK_ID with its companions, say which worker\n"
       "batch is.\n"
       "TRACEPARENT and TRACESTATE, without --traceparent, are the W3C trace context that calls belong to; "
       "malformed ones are not sent."}};
  page.see_also = {"latvoxd(8)"};
  return ToMan(facts, page);
}

}  // namespace latvox::client
