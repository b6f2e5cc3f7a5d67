#include "pieces.hpp"

namespace exact {

namespace {

V nearest_on(const V& a, const V& b, const V& x) {
    const V along = b - a;
    const Real t = dot(x - a, along) / dot(along, along);
    return a + std::min(std::max(t, Real(0)), Real(1)) * along;
}

Real part(const V& v, int i) {
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}
V axis(int i) {
    return {Real(i == 0), Real(i == 1), Real(i == 2)};
}

}  // namespace

Piece polygon(const std::vector<V>& corners, bool both_sides) {
    Piece p;
    p.corners = corners;
    p.both_sides = both_sides;
    V area;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const V& next = corners[(i + 1) % corners.size()];
        area += cross(corners[i] - corners[0], next - corners[0]);
        p.point += (Real(1) / static_cast<Real>(corners.size())) * corners[i];
    }
    p.normal = unit(area);
    p.ball = 0;
    for (const V& corner : corners) p.ball = std::max(p.ball, length(corner - p.point));
    return p;
}

Piece half_plane(const V& normal, Real offset, const V& edge, Real edge_offset, bool both_sides) {
    Piece p;
    p.both_sides = both_sides;
    p.normal = unit(normal);
    const Real level = offset / length(normal);
    // edge . x <= edge_offset, restricted to the plane: the part of `edge` along the normal is constant
    // there.
    const V flat = edge - dot(edge, p.normal) * p.normal;
    p.edge = unit(flat);
    p.edge_offset = (edge_offset - dot(edge, p.normal) * level) / length(flat);
    p.point = level * p.normal + p.edge_offset * p.edge;
    return p;
}

Real Piece::margin(const V& x) const {
    if (corners.empty()) return edge_offset - dot(edge, x);
    Real inside = INFINITY;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const V& a = corners[i];
        const V& b = corners[(i + 1) % corners.size()];
        inside = std::min(inside, dot(unit(cross(normal, b - a)), x - a));
    }
    return inside;
}

bool Piece::over(const V& x) const {
    return margin(x) >= 0;
}

V Piece::nearest(const V& x) const {
    const V foot = x - dot(x - point, normal) * normal;
    if (over(x)) return foot;
    if (corners.empty()) return foot - (dot(edge, foot) - edge_offset) * edge;
    V best = corners[0];
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const V on = nearest_on(corners[i], corners[(i + 1) % corners.size()], x);
        if (length(x - on) < length(x - best)) best = on;
    }
    return best;
}

std::optional<Foot> PieceTouch::step(const Piece& piece, const V& probe, Real radius) {
    doubt = INFINITY;
    const auto decide = [&](Real by) {
        doubt = std::min(doubt, std::fabs(by));
        return by >= 0;
    };
    const Real height = dot(probe - piece.point, piece.normal), inside = piece.margin(probe);
    const int side = decide(height) ? 1 : -1;
    const V last = last_, away = probe - piece.nearest(probe);
    const Real distance = length(away);
    const bool over = decide(inside), met = met_;
    last_ = probe, met_ = true;
    if (touched_ != 0) {
        if (side != touched_ && !over) let_go_ = LetGo::slipped;
        if (side == touched_ || !over) touched_ = 0;
    } else if (const Real before = dot(last - piece.point, piece.normal);
               met && (before > 0) != (height > 0) && let_go_ != LetGo::from_behind &&
               decide(piece.ball + radius - length(probe - piece.point))) {
        const V through = last + before / (before - height) * (probe - last);
        if (decide(piece.margin(through))) {
            let_go_ = before < 0 && !piece.both_sides ? LetGo::from_behind
                      : over                          ? LetGo::no
                                                      : LetGo::slipped;
            if (let_go_ == LetGo::no) touched_ = -side;
        }
    }
    if (touched_ != 0) return Foot{touched_ * piece.normal, touched_ * height - radius, INFINITY};
    if (side < 0 && over && !piece.both_sides) {
        let_go_ = LetGo::from_behind;
    } else if (decide(distance - radius)) {
        let_go_ = LetGo::no;
    }
    if (let_go_ != LetGo::no) return std::nullopt;
    return Foot{unit(away), distance - radius, distance};
}

std::optional<Foot> BoxTouch::step(const Box& box, const V& probe, Real radius) {
    doubt = INFINITY;
    const auto decide = [&](Real by) {
        doubt = std::min(doubt, std::fabs(by));
        return by >= 0;
    };
    const V q = turned_back(box.orientation, probe - box.center), last = last_;
    const bool met = met_;
    last_ = q, met_ = true;
    const auto above = [&](int i, int sign) { return sign * part(q, i) - part(box.half, i); };
    const auto over_face = [&](int i) {
        Real margin = INFINITY;
        for (int j = 0; j < 3; ++j) {
            if (j != i) margin = std::min(margin, part(box.half, j) - std::fabs(part(q, j)));
        }
        return decide(margin);
    };
    bool inside = true;
    for (int i = 0; i < 3; ++i) inside = decide(part(box.half, i) - std::fabs(part(q, i))) && inside;
    if (axis_ >= 0) {
        if (decide(above(axis_, sign_))) {
            axis_ = -1;
        } else if (!over_face(axis_)) {
            axis_ = -1, slipped_ = true;
        }
    } else if (!met) {
        if (inside) {
            Real nearest = -INFINITY, second = -INFINITY;
            for (int i = 0; i < 3; ++i) {
                for (const int sign : {1, -1}) {
                    if (above(i, sign) > nearest) {
                        second = nearest;
                        nearest = above(i, sign), axis_ = i, sign_ = sign;
                    } else {
                        second = std::max(second, above(i, sign));
                    }
                }
            }
            decide(nearest - second);
        }
    } else {
        // The face by which the path since the last step enters: of the three pairs of faces, the path enters
        // through the last pair that it comes between.
        Real enters = -INFINITY, leaves = INFINITY;
        int face = -1, sign = 1;
        for (int i = 0; i < 3; ++i) {
            const Real from = part(last, i), way = part(q, i) - from, half = part(box.half, i);
            if (way == 0) {
                if (std::fabs(from) > half) leaves = -INFINITY;
                continue;
            }
            const Real a = (-half - from) / way, b = (half - from) / way;
            if (std::min(a, b) > enters) enters = std::min(a, b), face = i, sign = way > 0 ? -1 : 1;
            leaves = std::min(leaves, std::max(a, b));
        }
        const Real way = length(q - last);
        if (enters <= leaves + 1e-9L && enters > -1e-9L && enters < 1 + 1e-9L) {
            doubt = std::min({doubt, std::fabs(leaves - enters) * way, std::fabs(enters) * way,
                              std::fabs(1 - enters) * way});
        }
        if (face >= 0 && enters <= leaves && enters >= 0 && enters <= 1 &&
            decide(length(box.half) + radius - length(q))) {
            if (over_face(face)) {
                axis_ = face, sign_ = sign, slipped_ = false;
            } else {
                slipped_ = true;
            }
        }
    }
    if (axis_ >= 0) {
        return Foot{turned(box.orientation, Real(sign_) * axis(axis_)), above(axis_, sign_) - radius,
                    INFINITY};
    }
    V out;
    for (int i = 0; i < 3; ++i) {
        const Real over = std::fabs(part(q, i)) - part(box.half, i);
        if (over > 0) out += (part(q, i) < 0 ? -over : over) * axis(i);
    }
    const Real distance = length(out);
    decide(distance - radius);
    if (slipped_) {
        if (distance < radius || (radius == 0 && inside)) return std::nullopt;
        slipped_ = false;
    }
    if (!(distance > 0)) return std::nullopt;
    return Foot{turned(box.orientation, unit(out)), distance - radius, distance};
}

V hollow_box(const Box& box, const V& probe, Real radius) {
    const V q = turned_back(box.orientation, probe - box.center);
    V back;
    for (int i = 0; i < 3; ++i) {
        const Real room = std::max(Real(0), part(box.half, i) - radius), at = part(q, i);
        if (std::fabs(at) > room) back += ((at < 0 ? -room : room) - at) * axis(i);
    }
    return turned(box.orientation, back);
}

}  // namespace exact
