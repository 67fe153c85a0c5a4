#include "tests/thesis/times.h"

#include <cmath>
#include <cstdio>

#include "core/base/kept_memory.h"
#include "tests/thesis/experiment.h"
#include "tests/thesis/table_file.h"
#include "tests/thesis/timing.h"

namespace latvox::thesis {
namespace {

void TimeTetrahedra(const Plan& plan, const std::string& round) {
  const Stopwatch watch;
  TableFile table(plan.directory + "/timing-" + round + ".csv",
                  "lattice,k,resolution,algorithm,degrees,voxels,seconds,fresh_seconds,array_voxels,array_seconds,"
                  "scan_seconds");
  for (const LatticeCase& lattice_case : LatticeCases()) {
    for (int32_t resolution : plan.timed_resolutions) {
      const Experiment experiment = MakeExperiment(lattice_case, resolution);
      for (double degrees : plan.timed_angles) {
        const TriangleMesh mesh = RotatedTetrahedron(degrees, experiment.side);
        for (const auto& [algorithm, name] : kAlgorithms) {
          const Timing t = Time(mesh, experiment, algorithm);
          table.Add("%s,%d,%d,%s,%.4f,%d,%.9f,%.9f,%d,%.9f,%.9f", lattice_case.name, lattice_case.k, resolution, name,
                    degrees, t.voxels, t.seconds, t.fresh_seconds, t.array_voxels, t.array_seconds, t.scan_seconds);
        }
      }
    }
  }
  table.Close();
  std::fprintf(stderr, "times, round %s: %.0f s\n", round.c_str(), watch.Seconds());
}

// An equilateral triangle in a cube of the given side: across it, with the normal (1, 1, 1), or normal to X.
TriangleMesh OneTriangle(double side, bool across) {
  const double leg = side / std::sqrt(2.0), low = (side - leg) / 2;
  const auto corner = [](double x, double y, double z) {
    return Vec3f{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  TriangleMesh mesh{{}, {{0, 1, 2}}};
  if (across) {
    mesh.vertices = {corner(low + leg, low, low), corner(low, low + leg, low), corner(low, low, low + leg)};
  } else {
    const double height = side * std::sqrt(0.75);
    mesh.vertices = {corner(side / 2, 0, 0), corner(side / 2, side, 0), corner(side / 2, side / 2, height)};
  }
  return mesh;
}

void TimeOrientations(const Plan& plan, const std::string& round) {
  TableFile table(plan.directory + "/orientation-" + round + ".csv",
                  "lattice,k,resolution,orientation,algorithm,array_voxels,array_seconds");
  for (const LatticeCase& lattice_case : LatticeCases()) {
    for (int32_t resolution : plan.orientation_resolutions) {
      const Experiment experiment = MakeExperiment(lattice_case, resolution);
      for (const char* orientation : {"parallel", "across"}) {
        const TriangleMesh mesh = OneTriangle(experiment.side, orientation[0] == 'a');
        for (const auto& [algorithm, name] : kAlgorithms) {
          if (algorithm == Algorithm::kExact) continue;
          const Timing t = Time(mesh, experiment, algorithm);
          table.Add("%s,%d,%d,%s,%s,%d,%.9f", lattice_case.name, lattice_case.k, resolution, orientation, name,
                    t.array_voxels, t.array_seconds);
        }
      }
    }
  }
  table.Close();
}

}  // namespace

void MeasureTimes(const Plan& plan, const std::string& round) {
  // The thesis's algorithms keep their voxels in the C library's heap. So that no algorithm pays for fresh pages in
  // every call, the heap keeps freed memory, as core does for the exact algorithm.
  KeepHeap(kHeapOfJobs);
  TimeTetrahedra(plan, round);
  TimeOrientations(plan, round);
}

}  // namespace latvox::thesis
