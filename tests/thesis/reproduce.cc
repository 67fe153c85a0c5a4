// Measures everything that the page of tests/thesis/run shows.
//   thesis_reproduce [--quick] DIRECTORY [NAME=MESH ...]
// Writes into DIRECTORY: accuracy.csv, timing.csv, models.csv, tables.csv, settings.csv. Each has a header line.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/mesh_files/mesh_file.h"
#include "tests/thesis/measure.h"
#include "tests/thesis/models.h"
#include "tests/thesis/tables.h"
#include "tests/thesis/timing.h"

namespace latvox::thesis {
namespace {

struct Plan {
  bool quick = false;
  std::string directory;
  std::vector<std::pair<std::string, std::string>> meshes;  // name, path
  std::vector<int32_t> resolutions;
  std::vector<double> angles, timed_angles;
};

Plan PlanFor(bool quick) {
  Plan plan;
  plan.quick = quick;
  const std::vector<double> angles = Angles();
  const int32_t top = quick ? 80 : 200;
  for (int32_t resolution = 10; resolution <= top; resolution += 10) plan.resolutions.push_back(resolution);
  for (size_t n = 0; n < angles.size(); n += quick ? 12 : 1) plan.angles.push_back(angles[n]);
  for (size_t n = 3; n < angles.size(); n += quick ? 72 : 17) plan.timed_angles.push_back(angles[n]);
  return plan;
}

class Table {
 public:
  Table(const Plan& plan, const char* name, const char* columns) : file_(plan.directory + "/" + name) {
    file_ << columns << "\n";
  }
  template <class... Args>
  void Add(const absl::FormatSpec<Args...>& format, const Args&... args) {
    file_ << absl::StrFormat(format, args...) << "\n";
  }
  void Close() {
    file_.close();
    if (file_) return;
    std::perror("thesis_reproduce: a table could not be written");
    std::exit(1);
  }

 private:
  std::ofstream file_;
};

class Stopwatch {
 public:
  double Seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
};

struct Run {
  const LatticeCase* lattice_case;
  int32_t resolution;
  double degrees;
  Algorithm algorithm;
  std::string_view name;
  Measurement measured = {};
};

// Runs the largest cases first, so that no thread ends with a large one alone.
double MeasureAccuracy(const Plan& plan) {
  const Stopwatch watch;
  const std::vector<LatticeCase> cases = LatticeCases();
  std::vector<Run> runs;
  for (auto resolution = plan.resolutions.rbegin(); resolution != plan.resolutions.rend(); ++resolution) {
    for (const LatticeCase& lattice_case : cases) {
      for (double degrees : plan.angles) {
        for (const auto& [algorithm, name] : kAlgorithms) {
          runs.push_back({&lattice_case, *resolution, degrees, algorithm, name});
        }
      }
    }
  }
  std::atomic<size_t> next = 0;
  oneapi::tbb::parallel_for(0, oneapi::tbb::this_task_arena::max_concurrency(), [&](int) {
    for (size_t n = next++; n < runs.size(); n = next++) {
      Run& run = runs[n];
      // A run that waits inside must not begin another.
      oneapi::tbb::this_task_arena::isolate([&] {
        run.measured = Measure(MakeExperiment(*run.lattice_case, run.resolution), run.degrees, run.algorithm);
      });
      if (n % 512 == 0) std::fprintf(stderr, "accuracy: %zu of %zu, %.0f s\n", n, runs.size(), watch.Seconds());
    }
  });

  Table table(plan, "accuracy.csv",
              "lattice,k,resolution,algorithm,degrees,voxels,points,displaced_volume,r,minimal,at_seam,"
              "by_other_surface,not_minimal,tunnels,redundant,tunnels_rounded,redundant_rounded");
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
    const Measurement& m = run->measured;
    table.Add("%s,%d,%d,%s,%.4f,%d,%d,%.9f,%.9f,%d,%d,%d,%d,%d,%d,%d,%d", run->lattice_case->name, run->lattice_case->k,
              run->resolution, run->name, run->degrees, m.voxels,
              MakeExperiment(*run->lattice_case, run->resolution).volume.points(), m.displaced, m.minimality.Ratio(),
              m.minimality.minimal, m.minimality.at_seam, m.minimality.by_other_surface, m.minimality.redundant,
              m.given.tunnels, m.given.redundant, m.rounded.tunnels, m.rounded.redundant);
  }
  table.Close();
  return watch.Seconds();
}

double MeasureTiming(const Plan& plan) {
  const Stopwatch watch;
  Table table(plan, "timing.csv",
              "lattice,k,resolution,algorithm,degrees,voxels,seconds,array_voxels,array_seconds,scan_seconds");
  for (const LatticeCase& lattice_case : LatticeCases()) {
    for (int32_t resolution : plan.resolutions) {
      const Experiment experiment = MakeExperiment(lattice_case, resolution);
      for (double degrees : plan.timed_angles) {
        for (const auto& [algorithm, name] : kAlgorithms) {
          const Timing t = Time(experiment, degrees, algorithm);
          table.Add("%s,%d,%d,%s,%.4f,%d,%.9f,%d,%.9f,%.9f", lattice_case.name, lattice_case.k, resolution, name,
                    degrees, t.voxels, t.seconds, t.array_voxels, t.array_seconds, t.scan_seconds);
        }
      }
    }
    std::fprintf(stderr, "timing: %s k=%d, %.0f s\n", lattice_case.name.c_str(), lattice_case.k, watch.Seconds());
  }
  table.Close();
  return watch.Seconds();
}

TriangleMesh Read(const std::string& path) {
  const auto file = client::ReadMesh(path);
  if (!file.ok()) {
    std::fprintf(stderr, "thesis_reproduce: %s\n", file.status().ToString().c_str());
    std::exit(1);
  }
  TriangleMesh mesh{{}, file->triangles};
  for (const auto& position : file->positions) mesh.vertices.push_back(position);
  return mesh;
}

double MeasureModels(const Plan& plan) {
  const Stopwatch watch;
  Table table(plan, "models.csv",
              "model,triangles,case,algorithm,voxels,tunnels,redundant,tunnels_rounded,redundant_rounded,seconds");
  for (const auto& [model, path] : plan.meshes) {
    const TriangleMesh mesh = Read(path);
    std::vector<ModelCase> cases = ModelCases();
    if (plan.quick) cases.erase(cases.begin() + 3, cases.end());
    for (const ModelCase& model_case : cases) {
      for (const auto& [algorithm, name] : kAlgorithms) {
        const ModelResult result = MeasureModel(mesh, model_case, algorithm);
        table.Add("%s,%d,\"%s\",%s,%d,%d,%d,%d,%d,%.3f", model, mesh.triangles.size(), model_case.Title(), name,
                  result.voxels, result.given.tunnels, result.given.redundant, result.rounded.tunnels,
                  result.rounded.redundant, result.seconds);
      }
    }
    std::fprintf(stderr, "models: %s, %.0f s\n", model.c_str(), watch.Seconds());
  }
  table.Close();
  return watch.Seconds();
}

void CheckTables(const Plan& plan) {
  Table table(plan, "tables.csv", "table,direction,m,n,det_n,true_n,spans,is_last,n_right,our_m,our_n,our_det_n");
  for (const TableRow& row : CheckedTables()) {
    table.Add("%s,%d %d %d,%s,%s,%g,%s,%d,%d,%d,%s,%s,%g", row.table, row.direction[0], row.direction[1],
              row.direction[2], TextOf(row.m), TextOf(row.n), row.det_n, TextOf(row.true_n), row.spans, row.is_last,
              row.n_right, TextOf(row.our_m), TextOf(row.our_n), row.our_det_n);
  }
  table.Close();
}

void MeasureAll(const Plan& plan) {
  CheckTables(plan);
  const double timing = MeasureTiming(plan);  // first, before the machine warms up
  const double accuracy = MeasureAccuracy(plan), models = MeasureModels(plan);
  Table table(plan, "settings.csv", "key,value");
  table.Add("quick,%d", plan.quick);
  table.Add("angles,%d", plan.angles.size());
  table.Add("timed_angles,%d", plan.timed_angles.size());
  table.Add("angle_seed,%d", kAngleSeed);
  table.Add("threads,%d", oneapi::tbb::this_task_arena::max_concurrency());
  table.Add("accuracy_seconds,%.1f", accuracy);
  table.Add("timing_seconds,%.1f", timing);
  table.Add("models_seconds,%.1f", models);
  table.Close();
}

}  // namespace
}  // namespace latvox::thesis

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool quick = !arguments.empty() && arguments[0] == "--quick";
  if (quick) arguments.erase(arguments.begin());
  latvox::thesis::Plan plan = latvox::thesis::PlanFor(quick);
  for (size_t n = 1; n < arguments.size(); ++n) {
    const size_t equals = arguments[n].find('=');
    if (equals == std::string::npos) arguments.clear();
    if (arguments.empty()) break;
    plan.meshes.emplace_back(arguments[n].substr(0, equals), arguments[n].substr(equals + 1));
  }
  if (arguments.empty()) {
    std::fprintf(stderr, "Usage: thesis_reproduce [--quick] DIRECTORY [NAME=MESH ...]\n");
    return 2;
  }
  plan.directory = arguments[0];
  latvox::thesis::MeasureAll(plan);
  return 0;
}
