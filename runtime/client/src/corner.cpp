#include "corner.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

namespace knurl::detail {

namespace {

using Eigen::Vector3d;

// Lengths are at the hand, in metres of the device.
constexpr double off = 0.1e-3;          // m, in front of the faces: on a face itself a model may be ambiguous
constexpr double same_place = 0.25e-3;  // m, of a foot from its expected place
constexpr double same_way = 0.985;      // cosine, 10 degrees
constexpr double folded = 0.94;         // cosine, 20 degrees: a smaller turn is that of a smooth surface
constexpr double opposed = -0.94;       // two walls that face each other do not meet
constexpr double farthest = 3 * max_look_ahead;  // m, from the hand to the corner
constexpr int rounds = 5;  // one for each face found, one to confirm them, one for curved ones

using Set = std::vector<Face>;

bool has(const Set& faces, const Face& face) {
    return std::any_of(faces.begin(), faces.end(), [&](const Face& one) { return same(one, face); });
}

bool may_meet(const Face& a, const Face& b) {
    const double cosine = a.normal().dot(b.normal());
    return cosine < folded && cosine > opposed;
}

/// b's foot is in front of a, and a's foot in front of b.
bool facing(const Face& a, const Face& b) {
    const Vector3d way = b.foot() - a.foot();
    return a.normal().dot(way) > 0 && b.normal().dot(way) < 0;
}

/// N N^T of the normals; none if they are so close to a plane or a line that their meeting point is
/// undefined.
std::optional<Eigen::LDLT<Eigen::MatrixXd>> independent(const Set& faces) {
    Eigen::MatrixX3d normals(faces.size(), 3);
    for (std::size_t i = 0; i < faces.size(); ++i)
        normals.row(static_cast<Eigen::Index>(i)) = faces[i].normal();
    Eigen::LDLT<Eigen::MatrixXd> gram(normals * normals.transpose());
    constexpr double flattest = 0.01;
    return gram.vectorD().minCoeff() > flattest ? std::optional(gram) : std::nullopt;
}

/// The point of all faces' tangent planes that is nearest to p: p - N^T (N N^T)^-1 heights.
std::optional<Vector3d> meeting_point(const Set& faces, const Vector3d& p, double metre) {
    const auto gram = independent(faces);
    if (!gram) return std::nullopt;
    Eigen::VectorXd heights(faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i)
        heights[static_cast<Eigen::Index>(i)] = faces[i].normal().dot(p - faces[i].foot());
    const Eigen::VectorXd shares = gram->solve(heights);
    Vector3d way = Vector3d::Zero();
    for (std::size_t i = 0; i < faces.size(); ++i)
        way -= shares[static_cast<Eigen::Index>(i)] * faces[i].normal();
    return way.norm() < metre * farthest ? std::optional<Vector3d>(p + way) : std::nullopt;
}

/// Along `face`, away from all other faces.
Vector3d away(const Face& face, const Set& faces) {
    Vector3d sum = Vector3d::Zero();
    for (const Face& other : faces) sum += other.normal();
    return (sum - sum.dot(face.normal()) * face.normal()).normalized();
}

void add_if_independent(Set& faces, const Face& face) {
    if (faces.size() == max_faces || has(faces, face)) return;
    faces.push_back(face);
    if (!independent(faces)) faces.pop_back();
}

/// What the model answers beside a corner, on each of its faces.
struct Answers {
    Set found;             // each once
    Set doubtful;          // faces of the corner at whose place the model has another
    bool in_place = true;  // every foot is where the corner's face has it
    bool news = false;     // a face that the corner does not have
};

Answers ask_beside(const Vector3d& corner, const Set& faces, Questions& questions) {
    const double metre = questions.metre();
    Answers answers;
    for (const Face& face : faces) {
        const Vector3d at = corner + metre * beside * away(face, faces);
        const Face answer = questions.ask_aside(at + metre * off * face.normal());
        if (!same(answer, face)) answers.doubtful.push_back(face);
        answers.news = answers.news || !has(faces, answer);
        if (!has(answers.found, answer)) answers.found.push_back(answer);
        answers.in_place = answers.in_place && (answer.foot() - at).norm() < metre * same_place;
    }
    return answers;
}

/// Faces that the model has confirmed meet in a concave corner.
bool is_concave(const Set& faces) {
    // All became one face: the surface turns from one to the other, so it is smooth.
    if (faces.size() < 2) return false;
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (!may_meet(faces[i], faces[j]) || !facing(faces[i], faces[j])) return false;
    return true;
}

/// The corner's faces as the model has them beside it: more than given if there is a third; none if there is
/// no such corner.
std::optional<Set> confirmed(Set faces, const Vector3d& p, Questions& questions) {
    for (int round = 0; round < rounds; ++round) {
        const std::optional<Vector3d> corner = meeting_point(faces, p, questions.metre());
        if (!corner) return std::nullopt;
        Answers answers = ask_beside(*corner, faces, questions);
        Set& found = answers.found;
        if (answers.doubtful.empty() && answers.in_place)
            return is_concave(found) ? std::optional(std::move(found)) : std::nullopt;
        // A face whose test point lies behind another face was not tested yet. But an answer exactly at the
        // edge may have a normal between those of two faces, and is no face.
        for (const Face& face : answers.doubtful) add_if_independent(found, face);
        if (found.size() < 2 || (!answers.doubtful.empty() && !answers.news)) return std::nullopt;
        faces = std::move(found);
    }
    return std::nullopt;
}

/// The answer on the hand's way is that face of the corner, and its foot is in front of all others: it is
/// nearer to the hand there than beside the corner.
bool clear_of(const Face& face, const Set& corner, double metre) {
    return has(corner, face) && std::all_of(corner.begin(), corner.end(), [&](const Face& other) {
               return same(other, face) ||
                      other.normal().dot(face.foot() - other.foot()) > metre * beside / 2;
           });
}

/// The model and this face agree about a hand at `landing`, unless the other faces have pushed it out.
bool harmless(const Face& face, const Set& corner, Vector3d landing, double tolerance, Questions& questions) {
    for (const Face& other : corner)
        if (!same(other, face))
            landing += std::max(0.0, questions.metre() * beside - other.height(landing)) * other.normal();
    const double height = face.height(landing);
    return height >= -tolerance || height >= questions.ask_aside(landing).height(landing) - tolerance;
}

}  // namespace

bool same(const Face& a, const Face& b) {
    return a.normal().dot(b.normal()) > same_way;
}

bool is_corner(const Face& a, const Face& b, const Vector3d& hand, Questions& questions) {
    return may_meet(a, b) && confirmed({a, b}, hand, questions);
}

void add_corner(Set& faces, std::span<const Face> candidates, const Vector3d& landing, double tolerance,
                Questions& questions) {
    for (const Face& candidate : candidates) {
        if (faces.size() == max_faces) return;
        const auto fits = [&](const Face& face) { return may_meet(face, candidate); };
        if (candidate.height(landing) > questions.metre() * max_look_ahead ||
            !std::all_of(faces.begin(), faces.end(), fits))
            continue;
        Set together = faces;
        together.push_back(candidate);
        std::optional<Set> corner = confirmed(std::move(together), landing, questions);
        if (!corner || !std::all_of(corner->begin(), corner->end(), [&](const Face& face) {
                return has(faces, face) || harmless(face, *corner, landing, tolerance, questions);
            }))
            continue;
        for (Face& face : *corner)
            for (const Face& chosen : faces)
                if (same(face, chosen) && clear_of(chosen, *corner, questions.metre())) face = chosen;
        faces = std::move(*corner);
    }
}

}  // namespace knurl::detail
