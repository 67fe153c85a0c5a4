// Cube roots that do not depend on the machine.
#ifndef LATVOX_CORE_LATTICE_CUBE_ROOT_H_
#define LATVOX_CORE_LATTICE_CUBE_ROOT_H_

namespace latvox {

// Returns the double nearest to the cube root of x. Precondition: x is positive and finite.
double CubeRoot(double x);

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_CUBE_ROOT_H_
