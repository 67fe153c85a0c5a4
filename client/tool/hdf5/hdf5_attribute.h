// Attributes of HDF5.
#ifndef LATVOX_CLIENT_TOOL_HDF5_HDF5_ATTRIBUTE_H_
#define LATVOX_CLIENT_TOOL_HDF5_HDF5_ATTRIBUTE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "client/tool/hdf5/hdf5_library.h"

namespace latvox::client {

// The attributes of one object. Functions return whether they succeed.
class Hdf5Attributes {
 public:
  // Precondition: the object stays open.
  Hdf5Attributes(const Hdf5& hdf5, hid_t object) : hdf5_(hdf5), object_(object) {}

  bool Write(const std::string& name, const std::string& text) const;  // UTF-8, without a zero
  bool Write(const std::string& name, int32_t value) const {
    return WriteNumbers(name, hdf5_.H5T_STD_I32LE_g, {}, &value);
  }
  bool Write(const std::string& name, double value) const {
    return WriteNumbers(name, hdf5_.H5T_IEEE_F64LE_g, {}, &value);
  }
  template <size_t N>
  bool Write(const std::string& name, const std::array<double, N>& values) const {
    return WriteNumbers(name, hdf5_.H5T_IEEE_F64LE_g, {N}, values.data());
  }
  template <class T, size_t N, size_t M>
  bool Write(const std::string& name, const std::array<std::array<T, N>, M>& rows) const {
    const hid_t type = sizeof(T) == sizeof(double) ? hdf5_.H5T_IEEE_F64LE_g : hdf5_.H5T_STD_I32LE_g;
    return WriteNumbers(name, type, {M, N}, rows.data());
  }

  // Reads exactly so many numbers of 64 or 32 bits. The file may have any type of numbers.
  bool Read(const char* name, double* values, size_t count) const;
  bool Read(const char* name, int32_t* values, size_t count) const;

  // Returns all texts, in the order of their names: those of one element, of variable length.
  bool ReadTexts(std::vector<std::pair<std::string, std::string>>& texts) const;

 private:
  bool WriteNumbers(const std::string& name, hid_t type, std::initializer_list<hsize_t> shape,
                    const void* values) const;
  bool ReadNumbers(const char* name, hid_t type, void* values, size_t count) const;
  Hdf5Id TextType() const;

  const Hdf5& hdf5_;
  const hid_t object_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_HDF5_HDF5_ATTRIBUTE_H_
