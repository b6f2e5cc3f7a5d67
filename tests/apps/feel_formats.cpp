// A cube, 2 wide, in every form of mesh file; and the one-line message for each invalid file.

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <knurl/geometry/mesh.hpp>
#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/meshfile/soup.hpp>

#include "feel_cube.hpp"
#include "program.hpp"

namespace {

using namespace knurl::test::cube_files;
using knurl::meshfile::MeshFile;
using knurl::test::Folder;

struct Written {
    const char* name;
    std::string bytes;
    const char* note = nullptr;  // the only one; none: nothing is said
};

TEST(MeshFormats, ACubeIsReadFromEveryFormThatItMayHave) {
    const std::string turned_faces = replaced(obj_faces(), "f ", "f -");
    const std::string v = obj_vertices();
    const std::vector<Written> all = {
        {"plain.obj", obj()},
        {"texture_and_normal_that_are_not_there.obj", v + "vn 0 0 1\n" + obj_faces("#/#/1")},
        {"normal.obj", v + "vn 0 0 1\n" + obj_faces("#//1")},
        {"texture.obj", v + "vt 0 0\n" + obj_faces("#/1")},
        {"open_slash.obj", v + obj_faces("#/")},
        {"from_the_end.obj", v + obj_faces("#", -8)},
        {"crlf.obj", replaced(obj(), "\n", "\r\n")},
        {"cr.obj", replaced(obj(), "\n", "\r")},
        {"tabs.obj", replaced(obj(), " ", "\t ")},
        {"bom.obj", "\xef\xbb\xbf" + obj()},
        {"goes_on.obj", replaced(v, "v ", "v \\\n") + replaced(obj_faces(), "f ", "f\\\r\n ")},
        {"goes_on_behind_blanks.obj", replaced(v, "v ", "v \\ \t\n") + obj_faces()},
        {"capitals.obj", replaced(replaced(obj(), "v", "V"), "f", "F")},
        {"comment_that_ends_with_a_backslash.obj", "# of C:\\parts\\\n" + v + "# C:\\\n" + obj_faces()},
        {"comment_behind.obj", replaced(obj(), "\n", " # here\n")},
        {"colours.obj", replaced(v, "\n", " 0.5 0.5 0.5\n") + obj_faces()},
        {"weight.obj", replaced(v, "\n", " 1.0\n") + obj_faces()},
        {"faces_first.obj", obj_faces() + v},
        {"groups.obj", "mtllib none.mtl\no cube\ng a b\ns off\n" + v + "usemtl steel plate\n" + obj_faces()},
        {"exponents.obj", replaced(replaced(v, "-1", "-1.0E+00"), " 1", " +10.e-1") + obj_faces()},
        {"points_too.obj", obj() + "p 1\nl 1 2 3\n", "2 points and lines are left out"},
        {"unknown.obj", obj() + "zz 1\nyy\n",
         "2 lines of other kinds are left out, the first is line 15: \"zz\""},
        {"plain.stl", stl_text()},
        {"upper.stl",
         [] {
             std::string text = stl_text();
             for (char& c : text) c = static_cast<char>(std::toupper(c));
             return text;
         }()},
        {"crlf.stl", replaced(stl_text(), "\n", "\r\n")},
        {"one_word_a_line.stl", replaced(replaced(stl_text(), "outer ", "outer\n"), "vertex ", "\nvertex ")},
        {"normals_that_are_none.stl", replaced(stl_text(), "normal 0 0 0", "normal nan -nan(ind) 1.#QNAN")},
        {"one_line.stl", "solid\n" + replaced(stl_text().substr(21), "\n", " ")},
        {"no_normals.stl", replaced(stl_text(), " normal 0 0 0", "")},
        {"filled_up.stl", stl_text() + std::string("\x1a\0\0\0", 4)},
        {"two_solids.stl", stl_text().substr(0, stl_text().find("  facet", 400)) + "endsolid\nSOLID\n" +
                               stl_text().substr(stl_text().find("  facet", 400))},
        {"no_end.stl", stl_text().substr(0, stl_text().find("endsolid")),
         "no \"endsolid\" at the end of the file: is it whole?"},
        {"binary.stl", stl_binary()},
        {"binary_that_begins_with_solid.stl", stl_binary(12, "solid cube\n facet normal")},
        {"count_of_0.stl", stl_binary(0), "its header counts 0 triangles; all 12 of the file are read"},
        {"count_of_-1.stl", stl_binary(0xffffffff),
         "its header counts -1 triangles; all 12 of the file are read"},
        {"solid_and_count_of_0.stl", stl_binary(0, std::string("solid x\n facet\0", 15)),
         "its header counts 0 triangles; all 12 of the file are read"},
        {"bytes_behind.stl", stl_binary() + "made by us", "10 bytes behind its 12 triangles are left out"},
        {"byte_behind.stl", stl_binary() + "\n", "1 byte behind its 12 triangles is left out"},
        {"an_stl_of_another_name.dat", stl_binary()},
        {"plain.ply", ply_text()},
        {"crlf.ply", replaced(ply_text(), "\n", "\r\n")},
        {"cr.ply", replaced(ply_text(), "\n", "\r")},
        {"vertex_index.ply", replaced(ply_text(), "vertex_indices", "vertex_index")},
        {"lists_of_other_types.ply", replaced(ply_text(), "list uchar int", "list double float")},
        {"a_ply_of_another_name.stl", ply_text()},
        {"edges.ply",
         replaced(ply_text(), "end_header",
                  "element edge 1\nproperty int vertex1\nproperty int vertex2\n"
                  "end_header") +
             "0 1\n",
         "1 point or line is left out"},
        {"little.ply", ply_binary<float, std::int32_t>(false, "float", "int", "\n")},
        {"big.ply", ply_binary<float, std::int32_t>(true, "float32", "int32", "\n")},
        {"doubles.ply", ply_binary<double, std::uint16_t>(true, "double", "ushort", "\n")},
        {"integers.ply", ply_binary<std::int8_t, std::uint8_t>(false, "char", "uchar", "\n")},
        {"crlf_and_bytes.ply", ply_binary<float, std::uint32_t>(false, "float", "uint", "\r\n")},
        {"cr_and_bytes.ply", ply_binary<float, std::uint32_t>(false, "float", "uint", "\r")},
        {"begins_with_0x0a.ply", ply_from_0x0a()},
        {"newline_behind_bytes.ply", ply_from_0x0a() + "\n"},
        {"strip.ply", ply_strip(one_strip())},
        {"strips.ply", ply_strip(six_strips())},
        {"strips_of_uint.ply", ply_strip(six_strips("4294967295"), "uint")},
        {"strips_of_uchar.ply", ply_strip(six_strips("255"), "uchar")},
    };
    const Folder folder;
    for (const Written& written : all) {
        SCOPED_TRACE(written.name);
        MeshFile file;
        try {
            file = knurl::meshfile::load_mesh(folder.file(written.name, written.bytes));
        } catch (const std::exception& error) {
            ADD_FAILURE() << error.what();
            continue;
        }
        EXPECT_EQ(file.triangles.size(), 12u);
        EXPECT_NEAR(volume(file), 8, 1e-12) << "all sides out";
        EXPECT_EQ(knurl::Mesh(file.triangles_of()).notes().edges_open, 0u);
        EXPECT_EQ(file.notes, written.note != nullptr ? std::vector<std::string>{written.note}
                                                      : std::vector<std::string>{});
    }
}

struct Refused {
    const char* name;
    std::string bytes;
    const char* says;  // behind the path, to its end
};

TEST(MeshFormats, WhatIsNoneIsRefusedAtItsPlace) {
    const std::string v = obj_vertices();
    const std::string cut = "write or fetch it again";
    const std::vector<Refused> all = {
        {"zero.obj", v + "f 0 1 2\n",
         ":9: f: a vertex has the number 0, they are counted from 1; export the file again"},
        {"above.obj", v + "f 1 2 3\nf 1 2 9\n",
         ":10: f: vertex 9 is not there, the file has 8; is it whole? Write or fetch it again"},
        {"back.obj", v + "f -1 -2 -9\n",
         ":9: f: vertex -9 is further back than the 8 before it; export the file again"},
        {"corner.obj", v + "f 1/1/1/1 2 3\n",
         ":9: f: \"1/1/1/1\" is not v, v/vt, v//vn or v/vt/vn; export the file again"},
        {"two.obj", "v 1 2\n", ":1: a vertex has 2 numbers instead of x, y and z; export the file again"},
        {"comma.obj", "v 1 2,5 3\n",
         ":1: v: \"2,5\" is not a number: the format has decimal points, no commas; write 2.5"},
        {"word.obj", "v 1 x 3\n", ":1: v: \"x\" is not a number; export the file again"},
        {"weight.obj", "v 1 2 3 0.5\n",
         ":1: a vertex has the weight 0.5, which only free-form surfaces have; leave it out"},
        {"surface.obj", v + "surf 0 1 0 1 1 2 3 4\n",
         ":9: \"surf\" is a free-form surface, and only polygons are read; let the program that made it "
         "write triangles"},
        {"bowtie.obj", "v 0 0 0\nv 3 2 0\nv 3 0 0\nv 0 3 0\nf 1 2 3 4\n",
         ":5: the outline of a polygon of 4 corners crosses itself, so its inside is not defined; let the "
         "program that "
         "made it write triangles"},
        {"star.obj", "v 0 3 0\nv 2 -3 0\nv -3 1 0\nv 3 1 0\nv -2 -3 0\nf 1 2 3 4 5\n",
         ":6: the outline of a polygon of 5 corners crosses itself, so its inside is not defined; let the "
         "program that "
         "made it write triangles"},
        {"points.obj", v, ": holds points or lines but no triangle; give a surface"},
        {"letter.obj", "Dear aunt,\n", ": is without content; give a file with triangles"},
        {"cut.stl", stl_text().substr(0, 300),
         ":17: the file ends within a facet: it is cut off; write or fetch it again"},
        {"comma.stl", replaced(stl_text(), "vertex -1", "vertex -1,5"),
         ":4: vertex: \"-1,5\" is not a number: the format has decimal points, no commas; write -1.5"},
        {"quads.stl", replaced(stl_text(), "    endloop", "vertex 0 0 0\nendloop"),
         ":7: a facet has a fourth vertex; STL has triangles: cut it into some"},
        {"cut_bytes.stl", stl_binary().substr(0, 300),
         ": byte 80: the header counts 12 triangles, which take 684 bytes, but the file has 300: it is cut "
         "off, or no "
         "STL; write or fetch it again"},
        {"count.stl", stl_binary(10),
         ": byte 80: the header counts 10 triangles, but 100 bytes follow them; write it again with the "
         "right count"},
        {"no_solid.stl", stl_text().substr(21),
         ":1: \"facet\" where \"solid\" belongs; export the file again"},
        {"letter.stl", "this is a letter to my aunt\n",
         ": is no STL: neither \"solid\" and facets, nor the 84 bytes that a binary file has before its "
         "triangles (28 "
         "are there); write or fetch it again"},
        {"name.ply", "ply\nformat ascii 1.0\nelement \x1b[31mred x\n",
         ":3: element ?[31mred has the count \"x\"; write a whole number"},
        {"head.ply", "ply\nformat ascii 1.0\n",
         ":3: the head has no \"end_header\": the file is cut off; write or fetch it again"},
        {"letter.ply", "this is a letter to my aunt\n",
         ": is no PLY: its first line is not \"ply\"; write or fetch it again"},
        {"version.ply", "ply\nformat ascii 2.0\n",
         ":2: version \"2.0\" of PLY is not known, 1.0 is; convert it"},
        {"type.ply", replaced(ply_text(), "float x", "real x"),
         ":6: \"real\" is no type of PLY; known are char, uchar, short, ushort, int, uint, float, double"},
        {"places.ply", replaced(ply_text(), "float z", "float w"),
         ": the head's vertices have no x, y and z; give a file with places"},
        {"index.ply", replaced(ply_text(), "4 0 2", "4 8 2"),
         ":20: vertex 8 is not there, the file has 8, counted from 0; export the file again"},
        {"below.ply", replaced(ply_text(), "4 0 2", "4 -1 2"),
         ":20: a vertex has a number below 0; export the file again"},
        {"more.ply", ply_text() + "3 0 1 2\n", ":26: more lines than the head counts; export the file again"},
        {"behind.ply", replaced(ply_text(), "1 1 1\n", "1 1 1 0\n"),
         ":18: \"0\" behind the values that the head states for element vertex; export the file again"},
        {"cut.ply", ply_text().substr(0, ply_text().size() - 6),
         ": ends within element face, after 5 of 6: it is cut off; write or fetch it again"},
        {"cut_bytes.ply", ply_from_0x0a().substr(0, 190),
         ": the head counts 8 of element vertex, which take 48 bytes or more, but 21 are left: it is cut "
         "off; "
         "write or "
         "fetch it again"},
        {"busy.ply", replaced(ply_from_0x0a(), "vertex 8", "vertex 4000000000"), nullptr},
        {"patches.ply", replaced(ply_text(), "element face", "element patch"),
         ": element patch has lists of vertices, and only face and tristrips are known; let the program that "
         "made it "
         "write faces"},
        {"empty.obj", "", ": is empty; write or fetch it again"},
    };
    const Folder folder;
    for (const Refused& refused : all) {
        SCOPED_TRACE(refused.name);
        const std::string path = folder.file(refused.name, refused.bytes);
        try {
            knurl::meshfile::load_mesh(path);
            ADD_FAILURE() << "was read";
        } catch (const std::runtime_error& error) {
            const std::string line = error.what();
            EXPECT_EQ(line.find('\n'), line.npos);
            if (refused.says != nullptr) {
                EXPECT_EQ(line, path + refused.says);
            }
        }
    }
}

TEST(MeshFormats, EveryCutOfAFileIsReadOrRefusedAndNothingElse) {
    const Folder folder;
    for (const auto& [name, bytes] :
         {std::pair{"c.obj", obj()},
          {"t.stl", stl_text()},
          {"b.stl", stl_binary()},
          {"t.ply", ply_text()},
          {"b.ply", ply_binary<double, std::int32_t>(false, "double", "int", "\n")},
          {"s.ply", ply_strip(six_strips())}})
        for (std::size_t length = 1; length < bytes.size(); length += 5) {
            try {
                const MeshFile file = knurl::meshfile::load_mesh(folder.file(name, bytes.substr(0, length)));
                for (const knurl::Triangle& t : file.triangles)
                    for (const std::uint32_t v : t) ASSERT_LT(v, file.vertices.size()) << name << length;
            } catch (const std::runtime_error& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            }
        }
}

TEST(MeshFormats, WhatLiesFarFromItsOriginIsReadToTheLastDigit) {
    const Folder folder;
    const std::string far =
        "v 412345.678 5654321.123 100.25\nv 412345.928 5654321.123 100.5\n"
        "v 412345.678 5654321.373 100.125\nf 1 2 3\n";
    const MeshFile file = knurl::meshfile::load_mesh(folder.file("utm.obj", far));
    EXPECT_EQ(file.vertices[1], (knurl::Point3{412345.928, 5654321.123, 100.5}));
    ASSERT_TRUE(file.far_middle());
    EXPECT_NEAR((*file.far_middle())[1], 5654321.248, 1e-6);
    EXPECT_FALSE(knurl::meshfile::load_mesh(folder.file("cube.obj", obj())).far_middle());
}

MeshFile loaded(const Folder& folder, const std::string& bytes) {
    return knurl::meshfile::load_mesh(folder.file("parts.obj", bytes));
}
/// A cube whose faces look inwards or outwards, `size` times as large, about (x, 0, 0).
std::string cube_obj(double size, double x, bool inside, int vertices_before) {
    std::ostringstream out;
    for (int c = 0; c < 8; ++c)
        out << "v " << size * place(c, 0) + x << ' ' << size * place(c, 1) << ' ' << size * place(c, 2)
            << '\n';
    for (const auto& q : quads) {
        out << "f";
        for (int i = 0; i < 4; ++i) out << ' ' << q[inside ? 3 - i : i] + 1 + vertices_before;
        out << '\n';
    }
    return out.str();
}

TEST(InsideOut, AClosedPartIsTurnedWithWhatLiesInItAndACavityStays) {
    struct Case {
        const char* what;
        std::string bytes;
        std::size_t turned;
        double volume;
    };
    const Folder folder;
    for (const Case& each : {
             Case{"outwards", cube_obj(1, 0, false, 0), 0, 8},
             Case{"inwards", cube_obj(1, 0, true, 0), 1, 8},
             Case{"a hollow one", cube_obj(1, 0, false, 0) + cube_obj(0.5, 0, true, 8), 0, 8 - 1},
             Case{"a hollow one, inwards", cube_obj(1, 0, true, 0) + cube_obj(0.5, 0, false, 8), 1, 8 - 1},
             Case{"one of two", cube_obj(1, 0, true, 0) + cube_obj(1, 3, false, 8), 1, 16},
             Case{"both", cube_obj(1, 0, true, 0) + cube_obj(1, 3, true, 8), 2, 16},
             Case{"in the box of the other, not in it", cube_obj(1, 0, false, 0) + cube_obj(0.2, 5, true, 8),
                  1, 8 + 0.064},
         }) {
        SCOPED_TRACE(each.what);
        MeshFile file = loaded(folder, each.bytes);
        const knurl::Mesh mesh(file.triangles_of());
        EXPECT_EQ(knurl::meshfile::turn_inside_out(file, mesh), each.turned);
        EXPECT_NEAR(volume(file), each.volume, 1e-9);
    }
    MeshFile open = loaded(folder, replaced(cube_obj(1, 0, true, 0), "f 7 8 6 5\n", ""));
    const knurl::Mesh mesh(open.triangles_of());
    EXPECT_EQ(knurl::meshfile::turn_inside_out(open, mesh), 0u) << "has no inside";
}

const std::string off_cube = [] {
    std::string out = "OFF\n8 6 0\n" + ply_vertices();
    return out + ply_faces();
}();

TEST(OtherFormats, AreReadInAProcessOfItsOwn) {
    const Folder folder;
    const MeshFile file = knurl::meshfile::load_mesh(folder.file("cube.off", off_cube));
    EXPECT_EQ(file.triangles.size(), 12u);
    EXPECT_NEAR(volume(file), 8, 1e-6);
    for (const char* name : {"letter.off", "letter.gltf", "letter.xyzzy"}) {
        try {
            knurl::meshfile::load_mesh(folder.file(name, "this is a letter to my aunt\n"));
            ADD_FAILURE() << name << " was read";
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(name));
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }
}

TEST(OtherFormats, AFileThatKeepsItsReaderBusyOrEatsMemoryEndsInOneLine) {
    const Folder folder;
    const auto refusal = [](const std::string& path, const knurl::meshfile::ReadLimits& limits) {
        try {
            knurl::meshfile::read_by_assimp(path, limits);
        } catch (const std::runtime_error& error) {
            return std::string(error.what());
        }
        return std::string("was read");
    };
    // A pipe without a writer blocks for ever.
    const std::string busy = folder.path("busy.off");
    ASSERT_EQ(mkfifo(busy.c_str(), 0600), 0);
    EXPECT_EQ(refusal(busy, {.seconds = 1}),
              busy + ": takes more than 1 s to read: it is damaged, or far too large");
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const std::string large = folder.file("large.off", "OFF\n400000000 1 0\n0 0 0\n");
    EXPECT_EQ(refusal(large, {.bytes = 1'000'000'000}),
              large + ": takes more than 1 GB of memory to read: it is damaged, or far too large");
#endif
}

TEST(OtherFormats, FacesThatTheImporterDropsAreMissed) {
    const Folder folder;
    const std::string path =
        folder.file("dropped.off", replaced(off_cube, "4 0 2 3 1", "4000000000 0 2 3 1"));
    try {
        knurl::meshfile::load_mesh(path);
        ADD_FAILURE() << "was read";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("its head counts 6 faces, of which "));
    }
}

}  // namespace
