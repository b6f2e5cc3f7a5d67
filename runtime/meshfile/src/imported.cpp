// The other formats, read by Assimp. A damaged file can make it run for ever, take all memory or crash. So it
// reads in a separate process, which sends back the result.

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>

#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/meshfile/soup.hpp>
#include <knurl/words/printable.hpp>

#include "words.hpp"

namespace knurl::meshfile {

namespace {

constexpr bool checked_memory =
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    true;  // a sanitizer reserves more than any limit
#else
    false;
#endif

/// Adds every mesh of the scene, at any level.
void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Soup& soup) {
    const aiMatrix4x4 here = above * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
        const auto first = static_cast<std::uint32_t>(soup.vertices.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D at = here * mesh.mVertices[v];
            soup.vertices.push_back({double{at.x}, double{at.y}, double{at.z}});
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices < 3) {
                ++soup.points_and_lines;
                continue;
            }
            for (unsigned i = 0; i < face.mNumIndices; ++i) soup.corners.push_back(first + face.mIndices[i]);
            soup.polygons.push_back({.corners = face.mNumIndices,
                                     .place = static_cast<std::uint32_t>(soup.polygons.size() + 1),
                                     .material = static_cast<std::uint8_t>(mesh.mMaterialIndex)});
        }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(scene, *node.mChildren[c], here, soup);
}

[[noreturn]] void too_much_memory(const std::string& path, const ReadLimits& limits) {
    bad(path, fmt::format("takes more than {:.2g} GB of memory to read: it is damaged, or far too large",
                          static_cast<double>(limits.bytes) * 1e-9));
}

Soup imported(const std::string& path, const ReadLimits& limits) {
    Soup soup;
    soup.path = path;
    Assimp::Importer importer;
    // Nothing is joined, split or smoothed here: the servo's builder does what is needed and reports it.
    const aiScene* scene = importer.ReadFile(path, 0);
    if (scene == nullptr || scene->mRootNode == nullptr) {
        std::string why = importer.GetErrorString();
        if (why.empty()) why = "no mesh in it";
        if (why.find("bad_alloc") != why.npos) too_much_memory(path, limits);
        bad(path, fmt::format("cannot be read as a mesh ({}); is it whole, and an STL, OBJ or PLY?",
                              knurl::words::printable(why, 300)));
    }
    if (scene->mNumMaterials > most_materials)
        bad(path,
            fmt::format("has {} materials; at most {}: join some", scene->mNumMaterials, most_materials));
    const aiImporterDesc* format =
        importer.GetImporterInfo(static_cast<std::size_t>(importer.GetPropertyInteger("importerIndex", 0)));
    soup.format = format != nullptr ? format->mName : "mesh";
    for (unsigned m = 0; m < scene->mNumMaterials; ++m)
        soup.material_names.emplace_back(scene->mMaterials[m]->GetName().C_Str());
    add(*scene, *scene->mRootNode, aiMatrix4x4(), soup);
    return soup;
}

// The content of the pipe: '+' and the soup, or '-' and the reason.

template <class T>
void put(std::string& out, const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t n = items.size();
    out.append(reinterpret_cast<const char*>(&n), sizeof n);
    out.append(reinterpret_cast<const char*>(items.data()), n * sizeof(T));
}
void put(std::string& out, const std::string& text) {
    put(out, std::vector<char>(text.begin(), text.end()));
}

/// Reads what put() wrote; false: it is incomplete.
template <class T>
bool take(std::string_view& in, std::vector<T>& items) {
    std::uint64_t n = 0;
    if (in.size() < sizeof n) return false;
    std::memcpy(&n, in.data(), sizeof n);
    in.remove_prefix(sizeof n);
    if (in.size() / sizeof(T) < n) return false;
    items.resize(n);
    if (n > 0) std::memcpy(items.data(), in.data(), n * sizeof(T));
    in.remove_prefix(n * sizeof(T));
    return true;
}
bool take(std::string_view& in, std::string& text) {
    std::vector<char> letters;
    if (!take(in, letters)) return false;
    text.assign(letters.begin(), letters.end());
    return true;
}

std::string written(const Soup& soup) {
    std::string out = "+";
    put(out, soup.format);
    put(out, soup.vertices);
    put(out, soup.corners);
    put(out, soup.polygons);
    put(out, std::vector<std::uint64_t>{soup.points_and_lines, soup.material_names.size()});
    for (const std::string& name : soup.material_names) put(out, name);
    return out;
}

bool taken(std::string_view in, Soup& soup) {
    std::vector<std::uint64_t> counts;
    if (!(take(in, soup.format) && take(in, soup.vertices) && take(in, soup.corners) &&
          take(in, soup.polygons) && take(in, counts) && counts.size() == 2))
        return false;
    soup.points_and_lines = counts[0];
    soup.material_names.resize(std::min<std::uint64_t>(counts[1], most_materials));
    for (std::string& name : soup.material_names)
        if (!take(in, name)) return false;
    return true;
}

[[noreturn]] void read_in_the_child(const std::string& path, const ReadLimits& limits, int out) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE})
        std::signal(signal, SIG_DFL);
    const auto limit = [](auto resource, rlim_t most) {
        const rlimit both{most, most};
        setrlimit(resource, &both);
    };
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds));
    if (!checked_memory) limit(RLIMIT_AS, limits.bytes);
    std::string answer;
    try {
        try {
            answer = written(imported(path, limits));
        } catch (const std::bad_alloc&) {
            too_much_memory(path, limits);
        }
    } catch (const std::exception& error) {
        answer = std::string("-") + error.what();
    }
    for (std::string_view rest = answer; !rest.empty();) {
        const ssize_t n = write(out, rest.data(), rest.size());
        if (n < 0 && errno != EINTR) _exit(1);
        if (n > 0) rest.remove_prefix(static_cast<std::size_t>(n));
    }
    _exit(0);
}

/// Detects faces that the importer drops silently: an OFF file's head gives their number.
void check_count(const Soup& soup) {
    std::ifstream in(soup.path);
    std::string line;
    if (!std::getline(in, line) || line.find("OFF") == line.npos) return;
    while (std::getline(in, line)) {
        std::string_view rest = std::string_view(line).substr(0, line.find('#'));
        next_word(rest);  // vertices
        const auto counted = integer_of(next_word(rest));
        if (!counted) continue;
        const std::uint64_t read = soup.polygons.size() + soup.points_and_lines;
        if (static_cast<std::uint64_t>(std::max(0ll, *counted)) > read)
            bad(soup.path, fmt::format("its head counts {} faces, of which {} can be read; write it again",
                                       *counted, read));
        return;
    }
}

/// Assimp's coordinates have single precision, which is coarse far from the origin.
void note_rounding(Soup& soup) {
    knurl::Point3 low{}, high{};
    double farthest = 0, size = 0;
    for (const knurl::Point3& v : soup.vertices)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = &v == soup.vertices.data() ? v[k] : std::min(low[k], v[k]);
            high[k] = &v == soup.vertices.data() ? v[k] : std::max(high[k], v[k]);
            farthest = std::max(farthest, std::abs(v[k]));
        }
    for (std::size_t k = 0; k < 3; ++k) size = std::max(size, high[k] - low[k]);
    const double rounding = std::ldexp(farthest, -24);
    if (rounding > 1e-5 * size)
        soup.notes.push_back(
            fmt::format("it lies {:.3g} from its origin, where this format's places are rounded by up to "
                        "{:.2g}; move it to the "
                        "origin, or write it as OBJ or PLY",
                        farthest, rounding));
}

/// Reads the pipe to its end; false: timeout.
bool read_all(int in, int seconds, std::string& answer) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::seconds(seconds);
    std::vector<char> some(1 << 20);
    for (;;) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        if (left <= 0) return false;
        pollfd ready{.fd = in, .events = POLLIN, .revents = 0};
        if (poll(&ready, 1, static_cast<int>(left)) <= 0) continue;
        const ssize_t n = read(in, some.data(), some.size());
        if (n == 0) return true;
        if (n > 0) answer.append(some.data(), static_cast<std::size_t>(n));
        if (n < 0 && errno != EINTR) return true;
    }
}

}  // namespace

Soup read_by_assimp(const std::string& path, const ReadLimits& limits) {
    int pipes[2];
    if (pipe(pipes) != 0) bad(path, std::string("cannot be read: no pipe: ") + std::strerror(errno));
    const pid_t child = fork();
    if (child == 0) {
        close(pipes[0]);
        read_in_the_child(path, limits, pipes[1]);
    }
    const int why_not = errno;
    close(pipes[1]);
    std::string answer;
    const bool ended = child > 0 && read_all(pipes[0], limits.seconds, answer);
    close(pipes[0]);
    if (child < 0) bad(path, std::string("cannot be read: no process: ") + std::strerror(why_not));
    if (!ended) kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!ended || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
        bad(path,
            fmt::format("takes more than {} s to read: it is damaged, or far too large", limits.seconds));
    if (answer.starts_with('-')) throw std::runtime_error(answer.substr(1));
    if (WIFSIGNALED(status) &&
        (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM || WTERMSIG(status) == SIGHUP))
        bad(path, "is not read: it was interrupted");
    Soup soup;
    soup.path = path;
    if (!answer.starts_with('+') || !taken(std::string_view(answer).substr(1), soup))
        bad(path, WIFSIGNALED(status)
                      ? fmt::format("is damaged: reading it ends the reader ({}); write or fetch it again",
                                    strsignal(WTERMSIG(status)))
                      : "cannot be read: its reader ended early; is there memory left?");
    check_count(soup);
    note_rounding(soup);
    return soup;
}

}  // namespace knurl::meshfile
