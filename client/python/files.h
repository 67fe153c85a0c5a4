// Files of voxels.
#ifndef LATVOX_CLIENT_PYTHON_FILES_H_
#define LATVOX_CLIENT_PYTHON_FILES_H_

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "client/python/voxels.h"

namespace latvox::client::python {

// Returns the voxels of a file. Their report is the object that `latvox info --json` prints. Throws the errors of
// ReadVoxelFile.
SharedVoxels OpenFile(const std::string& path);

// Writes the voxels of a file in other formats, as `latvox convert` does, and returns its warnings. Throws as
// ParseConvertKeywords and RunConvert.
pybind11::list Convert(const std::string& path, const pybind11::dict& keywords);

// Joins parts, as `latvox merge` does. Returns its JSON. Throws the errors of RunMerge.
std::string Merge(const std::vector<std::string>& parts, const std::string& out);

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_FILES_H_
