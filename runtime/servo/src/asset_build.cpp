// The builder's own process (asset_workshop.hpp).

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <new>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <knurl/protocol/text.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "asset_answer.hpp"
#include "asset_workshop.hpp"

namespace knurl::servo {

namespace {

using protocol::AssetSource;

// The whole source, checked: nobody can change it any more.
struct Source {
    AssetSource header;
    Triangles triangles;
    std::span<const AssetMaterial> materials;
};

[[noreturn]] void refuse(const std::string& text) {
    throw MeshError("asset: " + text);
}

template <class T>
std::span<const T> part(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t count) {
    return {reinterpret_cast<const T*>(bytes.data() + at), count};
}

Source read(std::span<const std::byte> bytes) {
    Source source;
    if (bytes.size() < sizeof(AssetSource))
        refuse(fmt::format("{} bytes are no mesh; send one", bytes.size()));
    std::memcpy(&source.header, bytes.data(), sizeof(AssetSource));
    const AssetSource& header = source.header;
    if (header.magic != AssetSource::magic_word || header.version != 1)
        refuse(
            "not made by this version of the library; build the application and the servo from the same "
            "version");
    if (header.kind != static_cast<std::uint32_t>(AssetKind::mesh) ||
        (header.flags & ~AssetSource::all_flags) != 0)
        refuse(fmt::format("kind {} with flags {:#x} is not known here; build both from the same version",
                           header.kind, header.flags));
    const auto layout = protocol::layout_of(header);
    if (!layout || layout->total != bytes.size())
        refuse(fmt::format(
            "{} vertices, {} triangles and {} materials do not make {} bytes; it is cut off, or its "
            "counts are wrong",
            header.vertices, header.triangles, header.materials, bytes.size()));
    source.triangles.vertices = part<Point3>(bytes, layout->vertices, header.vertices);
    source.triangles.triangles = part<Triangle>(bytes, layout->triangles, header.triangles);
    if ((header.flags & AssetSource::materials_of_triangles) != 0)
        source.triangles.materials = part<std::uint8_t>(bytes, layout->triangle_materials, header.triangles);
    static_assert(sizeof(AssetSource) % 8 == 0 && sizeof(AssetMaterial) == 24);
    source.materials = part<AssetMaterial>(bytes, layout->materials, header.materials);
    return source;
}

void require_sane(AssetMaterial material, std::size_t index) {
    const auto share = [&](double value, const char* name, double most) {
        if (!(value >= 0 && value <= most))
            refuse(fmt::format("material {}: {} = {:g}; give a share of the representation's, 0 to {:g}",
                               index, name, value, most));
    };
    share(material.stiffness, "stiffness", 1);
    share(material.damping, "damping", 1e3);
    share(material.friction, "friction", 1e3);
}

shm::UniqueFd build(std::uint64_t bytes, std::uint64_t budget, AssetAnswer& answer) {
    const shm::Segment memory = shm::Segment::open_sealed(STDIN_FILENO, bytes);
    const Source source = read({memory.data(), memory.size()});
    for (std::size_t i = 0; i < source.materials.size(); ++i) {
        answer.materials[i] = source.materials[i];
        require_sane(answer.materials[i], i);
    }
    answer.material_count = source.header.materials;
    const MeshBuild how{.exact = (source.header.flags & AssetSource::exact) != 0,
                        .weld = source.header.weld,
                        .budget = budget,
                        .find_crossings = (source.header.flags & AssetSource::no_crossings) == 0};
    const Mesh mesh(source.triangles, how);
    answer.ready.kind = source.header.kind;
    answer.ready.bytes = mesh.bytes();
    answer.ready.faces = mesh.faces();
    for (int i = 0; i < 3; ++i) {
        answer.ready.low[i] = mesh.low[i];
        answer.ready.high[i] = mesh.high[i];
    }
    answer.ready.notes = mesh.notes();
    answer.block_bytes = mesh.block_bytes();
    shm::Segment block = shm::Segment::create("knurl-asset", mesh.block_bytes());
    mesh.write({block.data(), block.size()});
    return shm::Segment::seal(std::move(block));
}

}  // namespace

int build_asset_main(int argc, const char* const* argv) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    AssetAnswer answer;
    shm::UniqueFd block;
    const auto fail = [&](const char* why) {
        answer.refused = 1;
        protocol::put_text(answer.text, why);
    };
    try {
        if (argc != 4) refuse("its builder is called as knurld calls it, by nobody else");
        block = build(std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10), answer);
    } catch (const std::bad_alloc&) {
        fail("asset: the machine has no memory to build it; send a smaller mesh");
    } catch (const std::exception& error) {
        fail(error.what());
    }
    const int fd = block.get();
    const std::span<const int> fds = block ? std::span<const int>(&fd, 1) : std::span<const int>();
    return shm::send_message(STDOUT_FILENO, std::as_bytes(std::span(&answer, 1)), fds) ? 0 : 1;
}

}  // namespace knurl::servo
