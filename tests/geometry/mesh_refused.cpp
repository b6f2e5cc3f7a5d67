// What the builder refuses, and its messages; when it stops; what it costs.

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

#include <gtest/gtest.h>
#include <malloc.h>

#include "mesh_data.hpp"
#include "raw_mesh.hpp"

using namespace knurl;
using namespace knurl::test;

namespace {

std::atomic<std::size_t> held{0}, most_held{0};

void* counted(std::size_t size, std::size_t alignment) {
    void* p = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (p == nullptr) throw std::bad_alloc();
    const std::size_t now = held += malloc_usable_size(p);
    if (now > most_held) most_held = now;
    return p;
}
void uncounted(void* p) {
    if (p != nullptr) held -= malloc_usable_size(p);
    std::free(p);
}

}  // namespace

void* operator new(std::size_t size) {
    return counted(size, 16);
}
void* operator new(std::size_t size, std::align_val_t a) {
    return counted(size, static_cast<std::size_t>(a));
}
void operator delete(void* p) noexcept {
    uncounted(p);
}
void operator delete(void* p, std::size_t) noexcept {
    uncounted(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
    uncounted(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
    uncounted(p);
}

namespace {

std::string refusal(const Triangles& given, const MeshBuild& how = {}) {
    try {
        const Mesh mesh(given, how);
    } catch (const MeshCancelled& e) {
        return std::string("cancelled: ") + e.what();
    } catch (const MeshError& e) {
        return e.what();
    }
    return "";
}

bool says(const std::string& text, std::initializer_list<const char*> words) {
    for (const char* w : words)
        if (text.find(w) == std::string::npos) return false;
    return text.find('\n') == std::string::npos;
}

#define EXPECT_SAYS(text, ...)                                      \
    do {                                                            \
        const std::string said = text;                              \
        EXPECT_TRUE(says(said, {__VA_ARGS__})) << "said: " << said; \
    } while (false)

TEST(MeshRefused, NothingToFeel) {
    EXPECT_SAYS(refusal({}), "no triangles");
    RawMesh raw = raw_box();
    raw.triangles.clear();
    EXPECT_SAYS(refusal(raw.given()), "no triangles");
    raw = raw_box();
    for (Point3& p : raw.vertices) p = {0.3, 0.3, 0.3};
    EXPECT_SAYS(refusal(raw.given()), "no triangle of the mesh is left", "12");
    for (Point3& p : raw.vertices) p = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
    EXPECT_SAYS(refusal(raw.given()), "no triangle of the mesh is left", "12");
    raw = raw_box();
    for (Triangle& t : raw.triangles) t = {3, 3, 3};
    EXPECT_SAYS(refusal(raw.given()), "no triangle of the mesh is left");
    const Triangle t{0, 1, 2};
    EXPECT_SAYS(refusal({{}, std::span(&t, 1)}), "triangle 0", "out of range", "0 vertices");
}

TEST(MeshRefused, VertexNumbersOutOfRange) {
    RawMesh raw = raw_sphere(2);
    raw.triangles[17][2] = 162;
    EXPECT_SAYS(refusal(raw.given()), "triangle 17", "162", "out of range");
    for (const std::size_t t : {20U, 30U, 40U, 50U}) raw.triangles[t][0] = 0xffffffff;
    EXPECT_SAYS(refusal(raw.given()), "triangles 17, 20, 30 and 2 more", "162");
}

TEST(MeshRefused, MaterialsThatAreNotOneForEach) {
    RawMesh raw = raw_box();
    raw.materials.resize(11);
    EXPECT_SAYS(refusal(raw.given()), "12 triangles", "materials", "11");
}

TEST(MeshRefused, AToleranceThatIsNone) {
    const RawMesh raw = raw_box();
    for (const double bad :
         {-1e-9, 0.2, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_SAYS(refusal(raw.given(), {.weld = bad}), "welding tolerance");
}

TEST(MeshRefused, ASurfaceWithOneSideOnly) {
    RawMesh raw = raw_strip(20, false);
    EXPECT_EQ(refusal(raw.given()), "");
    raw = raw_strip(20, true);
    EXPECT_SAYS(refusal(raw.given()), "Moebius", "triangle");
    // The same with clean parts; the message has the input's numbers.
    RawMesh both = raw_sphere(2);
    both.add(raw);
    const std::string said = refusal(both.given());
    const auto at = said.find("triangles ");
    ASSERT_NE(at, std::string::npos) << said;
    EXPECT_GE(std::atoi(said.c_str() + at + 10), 320) << said;
}

TEST(MeshRefused, MoreThanTheBudgetBeforeItIsTaken) {
    const RawMesh raw = raw_sphere(5);
    const std::size_t need = mesh_budget(raw.vertices.size(), raw.triangles.size(), false);
    MeshBuild how;
    how.budget = need - 1;
    const std::size_t before = held;
    most_held = before;
    EXPECT_SAYS(refusal(raw.given(), how), std::to_string(need).c_str(), std::to_string(need - 1).c_str(),
                "budget");
    EXPECT_LT(most_held - before, 4096);
    how.budget = need;
    EXPECT_EQ(refusal(raw.given(), how), "");
}

TEST(MeshRefused, NeverMoreThanWasSaidIsTaken) {
    const std::uint64_t seed = 0x5eed7;
    std::mt19937_64 random(seed);
    RawMesh flipped = raw_sphere(5);
    for (std::size_t t = 0; t < flipped.triangles.size(); ++t)
        if (random() % 2 == 0) flipped.turn_over(t);
    RawMesh doubled = raw_sphere(5);
    doubled.triangles.insert(doubled.triangles.end(), doubled.triangles.begin(), doubled.triangles.end());
    RawMesh needles = raw_grid(4, 4000, 1e-5);
    for (Point3& p : needles.vertices) p[0] *= 1000;
    for (const RawMesh& raw :
         {raw_sphere(2), raw_sphere(5), raw_sphere(5).unwelded(), raw_soup(random, 20000, 0.01),
          raw_soup(random, 3000, 1.0), flipped, doubled, needles, raw_cone(20000)}) {
        for (const bool exact : {false, true}) {
            MeshBuild how;
            how.exact = exact;
            const std::size_t said = mesh_budget(raw.vertices.size(), raw.triangles.size(), exact);
            how.budget = said;  // does not include memory for cuts
            const std::size_t before = held;
            most_held = before;
            const Mesh mesh(raw.given(), how);
            EXPECT_LE(most_held - before, said)
                << raw.triangles.size() << " exact " << exact << " seed " << seed;
            EXPECT_LE(said, 2 * (most_held - before))
                << raw.triangles.size() << " exact " << exact << ": too cautious";
            EXPECT_LE(mesh.bytes(), held - before + sizeof(Mesh));
            EXPECT_GE(mesh.bytes() + 8192, held - before);
        }
    }
}

TEST(MeshRefused, AnyQuestionMayEndTheBuilding) {
    // Sheets that cross, unwelded, turned, doubled, and many at one edge, so that all steps run.
    RawMesh raw = raw_sphere(3).unwelded(), other = raw_cone(100);
    for (std::size_t t = 0; t < raw.triangles.size(); t += 2) raw.turn_over(t);
    raw.add(other);
    raw.triangles.push_back(raw.triangles.back());
    const std::size_t before = held;
    std::size_t asked = 0;
    MeshBuild how;
    how.go_on = [&] { return ++asked, true; };
    EXPECT_EQ(refusal(raw.given(), how), "");
    const std::size_t all = asked;
    EXPECT_GE(all, 8) << "each step asks once at least";
    for (std::size_t last = 1; last <= all; ++last) {
        asked = 0;
        how.go_on = [&] { return ++asked < last; };
        EXPECT_SAYS(refusal(raw.given(), how), "cancelled");
        EXPECT_EQ(asked, last);
    }
    EXPECT_LE(held, before + 4096);
}

TEST(MeshRefused, TheQuestionsComeWithTheWork) {
    // Ten times the triangles, about ten times the queries: no step is one long slice.
    const auto questions = [](const RawMesh& raw) {
        std::size_t asked = 0;
        MeshBuild how;
        how.go_on = [&] { return ++asked, true; };
        const Mesh mesh(raw.given(), how);
        return asked;
    };
    const std::size_t few = questions(raw_sphere(4)), many = questions(raw_sphere(6));
    EXPECT_GE(many, 12 * (few - 8));
    EXPECT_GE(many, 81920 / 512) << "one for each 512 triangles";
    EXPECT_GE(questions(raw_cone(40000)), 80000 / 512);
}

}  // namespace
