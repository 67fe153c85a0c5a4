// Names of parts and materials; voxels carry their numbers. Programs need no OpenVDB header for this.
//
// Grids of latvox::client::FieldGrids keep them in their metadata, if the mesh's file has some:
//
//   latvox_part_names, latvox_material_names   a JSON array of strings; the n-th is the name of number n, "" if unknown
#ifndef LATVOX_LATVOX_GRID_CARRIED_NAMES_H_
#define LATVOX_LATVOX_GRID_CARRIED_NAMES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "latvox/export.h"
#include "latvox/grid/voxel_grid.h"
#include "latvox/types.h"

namespace latvox::client {

// Names by number. Numbers beyond the last name have none.
struct CarriedNames {
  std::vector<std::string> parts;      // of Field::kPart; "": unknown
  std::vector<std::string> materials;  // of Field::kMaterial; "": unknown
  bool operator==(const CarriedNames&) const = default;

  // Returns the names of a field: only kPart and kMaterial have some.
  const std::vector<std::string>& Of(Field field) const {
    static const std::vector<std::string> kNone;
    return field == Field::kPart ? parts : field == Field::kMaterial ? materials : kNone;
  }

  // Returns the name of a number, or "".
  std::string Of(Field field, uint32_t number) const {
    const std::vector<std::string>& names = Of(field);
    return number < names.size() ? names[number] : "";
  }
};

// Returns the names in the metadata of a file. Metadata that are no array of strings give none.
LATVOX_EXPORT CarriedNames ReadCarriedNames(const GridFileInfo& info);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_CARRIED_NAMES_H_
