// Reads meshes of formats that latvox itself does not read.
#ifndef LATVOX_TESTS_BENCH_SCENE_FILE_H_
#define LATVOX_TESTS_BENCH_SCENE_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "core/mesh/mesh.h"

namespace latvox {

// Returns all triangles of the scene in world coordinates, as assimp reads them. Errors: INVALID_ARGUMENT.
absl::StatusOr<TriangleMesh> ReadSceneFile(const std::string& path);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_SCENE_FILE_H_
