// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/triangle_mesh.h"

namespace lbm {

/// Reads a binary or an ASCII .stl file. Corners that lie within a millionth of the mesh's size are
/// one; triangles without an area are left out. Normals in the file are not looked at: the corners'
/// order says which side is outside.
/// @throws std::invalid_argument  what is wrong with the file, and what to do
TriangleMesh read_stl(const std::string& path);

/// Writes an ASCII .stl file, which LIGGGHTS and ParaView read.
/// @throws InputError  it cannot be written
void write_stl(const std::string& path, const TriangleMesh& mesh);

}  // namespace lbm
