#include "client/tool/hdf5/hdf5_attribute.h"

namespace latvox::client {

Hdf5Id Hdf5Attributes::TextType() const {
  Hdf5Id type(hdf5_.H5Tcopy(hdf5_.H5T_C_S1_g), hdf5_.H5Tclose);
  const bool good = type.ok() && hdf5_.H5Tset_size(type.get(), H5T_VARIABLE) >= 0 &&
                    hdf5_.H5Tset_cset(type.get(), H5T_CSET_UTF8) >= 0;
  return good ? std::move(type) : Hdf5Id();
}

bool Hdf5Attributes::Write(const std::string& name, const std::string& text) const {
  const Hdf5Id type = TextType();
  const char* const value = text.c_str();
  return type.ok() && WriteNumbers(name, type.get(), {}, &value);
}

bool Hdf5Attributes::WriteNumbers(const std::string& name, hid_t type, std::initializer_list<hsize_t> shape,
                                  const void* values) const {
  const auto ranks = static_cast<int>(shape.size());
  const Hdf5Id space(
      ranks == 0 ? hdf5_.H5Screate(H5S_SCALAR) : hdf5_.H5Screate_simple(ranks, std::data(shape), nullptr),
      hdf5_.H5Sclose);
  if (!space.ok()) return false;
  const Hdf5Id attribute(hdf5_.H5Acreate2(object_, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         hdf5_.H5Aclose);
  return attribute.ok() && hdf5_.H5Awrite(attribute.get(), type, values) >= 0;
}

bool Hdf5Attributes::Read(const char* name, double* values, size_t count) const {
  return ReadNumbers(name, hdf5_.H5T_IEEE_F64LE_g, values, count);
}

bool Hdf5Attributes::Read(const char* name, int32_t* values, size_t count) const {
  return ReadNumbers(name, hdf5_.H5T_STD_I32LE_g, values, count);
}

bool Hdf5Attributes::ReadNumbers(const char* name, hid_t type, void* values, size_t count) const {
  const Hdf5Id attribute(hdf5_.H5Aopen(object_, name, H5P_DEFAULT), hdf5_.H5Aclose);
  if (!attribute.ok()) return false;
  const Hdf5Id space(hdf5_.H5Aget_space(attribute.get()), hdf5_.H5Sclose);
  return space.ok() && hdf5_.H5Sget_simple_extent_npoints(space.get()) == static_cast<hssize_t>(count) &&
         hdf5_.H5Aread(attribute.get(), type, values) >= 0;
}

bool Hdf5Attributes::ReadTexts(std::vector<std::pair<std::string, std::string>>& texts) const {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5A_info_t*, void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  if (hdf5_.H5Aiterate2(object_, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0) return false;
  const Hdf5Id text_type = TextType();
  for (const std::string& name : names) {
    const Hdf5Id attribute(hdf5_.H5Aopen(object_, name.c_str(), H5P_DEFAULT), hdf5_.H5Aclose);
    if (!attribute.ok()) return false;
    const Hdf5Id type(hdf5_.H5Aget_type(attribute.get()), hdf5_.H5Tclose);
    const Hdf5Id space(hdf5_.H5Aget_space(attribute.get()), hdf5_.H5Sclose);
    if (!type.ok() || !space.ok()) return false;
    if (hdf5_.H5Tget_class(type.get()) != H5T_STRING || hdf5_.H5Tis_variable_str(type.get()) <= 0) continue;
    if (hdf5_.H5Sget_simple_extent_npoints(space.get()) != 1) continue;
    char* text = nullptr;
    if (hdf5_.H5Aread(attribute.get(), text_type.get(), &text) < 0) return false;
    texts.emplace_back(name, text != nullptr ? text : "");
    hdf5_.H5free_memory(text);
  }
  return true;
}

}  // namespace latvox::client
