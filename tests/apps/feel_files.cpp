// Mesh files of the usual kinds, and the messages for invalid ones.

#include <cmath>
#include <cstring>
#include <sstream>

#include <generators.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>
#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/meshfile/unit.hpp>

#include "../refusal.hpp"
#include "material.hpp"
#include "program.hpp"
#include "record.hpp"
#include "stroke.hpp"

namespace {

using knurl::test::Folder;
using testing::AllOf;
using testing::HasSubstr;

using Made = knurl::test::MadeMesh;

std::string as_obj(const Made& mesh) {
    std::ostringstream out;
    out.precision(17);
    for (const auto& v : mesh.vertices) out << "v " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
    for (const auto& t : mesh.triangles)
        out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    return out.str();
}

std::string as_ply(const Made& mesh) {
    std::ostringstream out;
    out.precision(9);
    out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const auto& v : mesh.vertices) out << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
    for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    return out.str();
}

std::string as_stl(const Made& mesh) {
    std::string out(80, ' ');
    const auto put = [&](const auto& value) {
        out.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) put(0.0f);
        for (const std::uint32_t v : t)
            for (const double x : mesh.vertices[v]) put(static_cast<float>(x));
        put(std::uint16_t{0});
    }
    return out;
}

std::string refusal(const std::string& path) {
    return knurl::test::refusal_of([&] { knurl::meshfile::load_mesh(path); });
}

TEST(MeshFiles, TheSameThingComesOutOfEveryFormat) {
    const Folder folder;
    const Made ball = knurl::test::icosphere(2, 0.1);
    for (const auto& [name, text] : {std::pair{"ball.obj", as_obj(ball)}, std::pair{"ball.ply", as_ply(ball)},
                                     std::pair{"ball.stl", as_stl(ball)}}) {
        SCOPED_TRACE(name);
        const knurl::meshfile::MeshFile file = knurl::meshfile::load_mesh(folder.file(name, text));
        EXPECT_EQ(file.triangles.size(), ball.triangles.size());
        EXPECT_NEAR(file.size(), 0.2 * std::sqrt(3), 0.02);
        // The outside stays outside, and faces with a common edge keep it after welding.
        const knurl::Mesh mesh(file.triangles_of());
        EXPECT_EQ(mesh.notes().edges_open, 0u);
        EXPECT_EQ(mesh.notes().faces_turned, 0u);
    }
}

TEST(MeshFiles, MaterialsOfAnObjBecomeMaterialsOfItsTriangles) {
    const Folder folder;
    folder.file("m.mtl", "newmtl hard\nKd 1 0 0\nnewmtl soft\nKd 0 1 0\n");
    const knurl::meshfile::MeshFile file = knurl::meshfile::load_mesh(folder.file(
        "m.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl hard\nf 1 2 3\nusemtl soft\nf 1 2 4\n"));
    ASSERT_EQ(file.triangles.size(), 2u);
    EXPECT_NE(file.materials[0], file.materials[1]);
    EXPECT_THAT(file.material_names, testing::Contains("hard"));
    EXPECT_THAT(file.material_names, testing::Contains("soft"));
}

std::string refused(const std::vector<std::string>& settings) {
    return knurl::test::refusal_of([&] { feel::materials_of({"hard", "soft"}, settings); });
}

TEST(Materials, AreSharesByTheNamesOfTheFile) {
    EXPECT_TRUE(feel::materials_of({"hard", "soft"}, {}).empty());
    const auto materials = feel::materials_of({"hard", "soft", "a=b"}, {"soft=0.25", "a=b=0.5,2,3"});
    ASSERT_EQ(materials.size(), 3u);
    EXPECT_EQ(materials[0].stiffness, 1);
    EXPECT_EQ(materials[1].stiffness, 0.25);
    EXPECT_EQ(materials[1].friction, 1);
    EXPECT_EQ(materials[2].stiffness, 0.5);
    EXPECT_EQ(materials[2].damping, 2);
    EXPECT_EQ(materials[2].friction, 3);
    EXPECT_THAT(refused({"sofd=1"}), HasSubstr("it has hard, soft"));
    EXPECT_THAT(refused({"soft=2"}), HasSubstr("\"2\" is no share of stiffness; give 0 to 1"));
    EXPECT_THAT(refused({"soft=1,nan"}), HasSubstr("\"nan\" is no share of damping"));
    EXPECT_THAT(refused({"soft=1,1,"}), HasSubstr("\"\" is no share of friction"));
    EXPECT_THAT(refused({"soft=1,1,1,1"}), HasSubstr("more than three"));
    EXPECT_THAT(refused({"soft"}), HasSubstr("NAME=STIFFNESS"));
}

TEST(MeshFiles, WhatIsNoMeshIsNamedWithTheRemedy) {
    const Folder folder;
    const Made ball = knurl::test::icosphere(2, 0.1);
    EXPECT_THAT(refusal(folder.path("nowhere.stl")), AllOf(HasSubstr("nowhere.stl"), HasSubstr("not there")));
    EXPECT_THAT(refusal(folder.path("")), HasSubstr("is no file"));
    EXPECT_THAT(refusal(folder.file("empty.stl", "")), HasSubstr("empty.stl"));
    EXPECT_THAT(refusal(folder.file("text.stl", "this is a letter to my aunt\n")), HasSubstr("text.stl"));
    EXPECT_THAT(refusal(folder.file("cut.stl", as_stl(ball).substr(0, 3000))), HasSubstr("cut.stl"));
    EXPECT_THAT(refusal(folder.file("cut.ply", as_ply(ball).substr(0, 3000))), HasSubstr("cut.ply"));
    EXPECT_THAT(refusal(folder.file("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), HasSubstr("points.obj"));
}

TEST(Units, AreGuessedByWhatAHandCanHold) {
    EXPECT_EQ(knurl::meshfile::guessed_unit(200).name, "mm");
    EXPECT_EQ(knurl::meshfile::guessed_unit(15).name, "cm");
    EXPECT_EQ(knurl::meshfile::guessed_unit(0.25).name, "m");
    EXPECT_EQ(knurl::meshfile::guessed_unit(1e6).name, "mm") << "larger than anything: the smallest";
    EXPECT_EQ(knurl::meshfile::unit_of("in").metres, 0.0254);
    EXPECT_THROW(knurl::meshfile::unit_of("furlong"), std::runtime_error);
    EXPECT_FALSE(knurl::meshfile::odd_size(0.3));
    EXPECT_THAT(*knurl::meshfile::odd_size(200), HasSubstr("200 m large"));
    EXPECT_THAT(*knurl::meshfile::odd_size(2e-6), HasSubstr("2 um small"));
}

TEST(Stroke, GoesAroundWhatItDoesNotKnow) {
    const Made ball = knurl::test::icosphere(4, 0.05);
    const knurl::Mesh mesh({.vertices = ball.vertices, .triangles = ball.triangles});
    std::vector<feel::Row> rows = feel::make_stroke(mesh, {.speed = 0.1, .press = 0.004});
    ASSERT_GT(rows.size(), 1000u);
    std::vector<feel::Cycle> cycles;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        cycles.push_back({.number = i + 1, .t = rows[i].t, .position = rows[i].position});
        if (i == 0) continue;
        const double step = (rows[i].position - rows[i - 1].position).norm();
        EXPECT_LE(step / (rows[i].t - rows[i - 1].t), 0.1 * (1 + 1e-9)) << i;
    }
    feel::expect(cycles, mesh, 1000, 100);
    const auto touching =
        std::count_if(cycles.begin(), cycles.end(), [](const auto& c) { return c.touching; });
    EXPECT_GT(static_cast<double>(touching), 0.7 * static_cast<double>(cycles.size()));
    for (const feel::Cycle& cycle : cycles) {
        EXPECT_NEAR(cycle.expected.norm(), cycle.touching ? 1000 * 0.004 : 0, cycle.touching ? 0.8 : 0)
            << cycle.t;
    }
}

TEST(Judge, CountsWhatDiffers) {
    std::vector<feel::Cycle> cycles(4);
    for (std::size_t i = 0; i < 4; ++i) {
        cycles[i].number = i + 1 + (i == 3 ? 2 : 0);
        cycles[i].force = cycles[i].expected = {0, 0, 1.0};
    }
    cycles[1].force = {0, 0, 1.7};
    cycles[2].expected = Eigen::Vector3d::Zero();
    const feel::Judgement judged = feel::judge(cycles);
    EXPECT_EQ(judged.missed, 2u);
    EXPECT_NEAR(judged.worst_error, 1.0, 1e-15);
    EXPECT_EQ(judged.lost, 1u);
    EXPECT_EQ(judged.jumps, 2u);
    EXPECT_EQ(judged.expected_jumps, 1u);
}

}  // namespace
