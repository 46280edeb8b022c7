// Writes what OpenVDB's Python module cannot: other compressions, types and transforms, and grids that share voxels.
//
//     apt-get install g++ libopenvdb-dev libboost-dev libboost-iostreams-dev libtbb-dev libimath-dev
//     g++ -std=c++17 formats.cpp -o formats -lopenvdb -ltbb -lImath -lboost_iostreams && ./formats
//
// Identifiers of files are random, so their bytes differ each time; their voxels do not.

#include <openvdb/openvdb.h>

using namespace openvdb;

// The value of voxel i, j, k of a block of 10^3.
static float value(int i, int j, int k) { return float((i * 7 + j * 3 + k) % 16) / 16; }

static FloatGrid::Ptr block(const char* name) {
    FloatGrid::Ptr grid = FloatGrid::create();
    grid->setName(name);
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j)
            for (int k = 0; k < 10; ++k) grid->tree().setValue(Coord(i - 5, j, k), value(i, j, k));
    return grid;
}

template <typename Grid>
static typename Grid::Ptr filled(const char* name, typename Grid::ValueType value) {
    typename Grid::Ptr grid = Grid::create();
    grid->setName(name);
    grid->fill(CoordBBox(Coord(0), Coord(3)), value);
    return grid;
}

static void write(const char* file, uint32_t compression, GridCPtrVec grids) {
    io::File out(file);
    out.setCompression(compression);
    out.write(grids);
}

int main() {
    initialize();
    const uint32_t zip = io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK, active = io::COMPRESS_ACTIVE_MASK;
    write("zip.vdb", zip, {block("density")});
    FloatGrid::Ptr half = block("density");
    half->setSaveFloatAsHalf(true);
    write("zip_half.vdb", zip, {half});
    write("plain.vdb", active, {block("density")});
    write("types.vdb", zip, {filled<Int32Grid>("count", 3), filled<Int64Grid>("large", 3),
        filled<DoubleGrid>("double", 3), filled<MaskGrid>("mask", true)});

    FloatGrid::Ptr original = block("density"), shared = original->copy();
    shared->setName("copy");
    shared->setTransform(math::Transform::createLinearTransform(0.5));
    write("shared.vdb", zip, {original, shared});
    FloatGrid::Ptr frustum = block("frustum"), turned = block("turned");
    const BBoxd box(Vec3d(0), Vec3d(100));
    frustum->setTransform(math::Transform::createFrustumTransform(box, 0.5, 2, 1));
    turned->transform().preRotate(M_PI / 2, math::Z_AXIS);
    turned->transform().postTranslate(Vec3d(1, 2, 3));
    write("transforms.vdb", zip, {frustum, turned, block("density"), block("density")});
}
