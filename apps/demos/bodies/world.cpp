#include "world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include <btBulletDynamicsCommon.h>
#include <fmt/format.h>

namespace bodies {

namespace {

constexpr double larger = 20;        // Bullet's units in a metre
constexpr double margin = 0.5e-3;    // m, of Bullet's boxes
constexpr double touching = 0.3e-3;  // m: bodies this close lean on each other
constexpr int solver_rounds = 60;    // Bullet's default is 10; stacks with unequal weights need more
constexpr double rolling = 2e-4;     // m, rolling friction of a ball: the offset of the floor's support
constexpr double fastest = 3;        // m/s, of a point of a body: a higher speed is an error
constexpr int mobility_rounds = 100;
constexpr int settling = 300;               // steps of a millisecond before it begins
constexpr double longest_part = 1.0 / 480;  // s, part of a step: in 1/60 s a falling thing sinks 2.7 mm into
                                            // the floor

int parts_of(double dt) {
    return std::max(1, static_cast<int>(std::ceil(dt / longest_part - 1e-6)));
}

btVector3 to_bullet(const Vector3d& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vector3d from_bullet(const btVector3& v) {
    return {double{v.x()}, double{v.y()}, double{v.z()}};
}
Quaterniond from_bullet(const btQuaternion& q) {
    return Quaterniond(double{q.w()}, double{q.x()}, double{q.y()}, double{q.z()}).normalized();
}

Vector3d rotation_vector(const Quaterniond& from, const Quaterniond& to) {
    Quaterniond turn = to * from.conjugate();
    if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
    const Eigen::AngleAxisd axis(turn);
    return axis.angle() * axis.axis();
}

}  // namespace

struct World::Engine {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> rigid;  // the bodies, then the tray

    ~Engine() {
        for (const auto& body : rigid) world.removeRigidBody(body.get());
    }
    void add(std::unique_ptr<btCollisionShape> shape, double mass, const Vector3d& position,
             double friction) {
        btVector3 inertia(0, 0, 0);
        if (mass > 0) shape->calculateLocalInertia(static_cast<btScalar>(mass), inertia);
        btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, shape.get(),
                                                      inertia);
        info.m_startWorldTransform.setIdentity();
        info.m_startWorldTransform.setOrigin(to_bullet(larger * position));
        info.m_friction = static_cast<btScalar>(friction);
        if (shape->getShapeType() == SPHERE_SHAPE_PROXYTYPE)
            info.m_rollingFriction = static_cast<btScalar>(rolling * larger);
        rigid.push_back(std::make_unique<btRigidBody>(info));
        rigid.back()->setActivationState(DISABLE_DEACTIVATION);
        shapes.push_back(std::move(shape));
        world.addRigidBody(rigid.back().get());
    }
};

World::World(std::vector<Body> bodies, const Tray& tray, double gravity)
    : bodies_(std::move(bodies)), tray_(tray), gravity_(gravity), engine_(std::make_unique<Engine>()) {
    auto& world = engine_->world;
    world.setGravity(to_bullet({0, 0, -larger * gravity}));
    world.getSolverInfo().m_numIterations = solver_rounds;
    for (const Body& body : bodies_) {
        if (!(body.mass > 0) || !(body.half.minCoeff() > 2 * margin) || !body.position.allFinite())
            throw std::runtime_error(fmt::format(
                "{}: a body has a mass, is thicker than {} mm and lies somewhere", body.name, 4e3 * margin));
        std::unique_ptr<btCollisionShape> shape;
        if (body.form == Body::Form::ball) {
            shape = std::make_unique<btSphereShape>(static_cast<btScalar>(larger * body.half.x()));
        } else {
            shape = std::make_unique<btBoxShape>(to_bullet(larger * body.half));
            shape->setMargin(static_cast<btScalar>(larger * margin));
        }
        engine_->add(std::move(shape), body.mass, body.position, body.friction);
        after_.push_back({.position = body.position});
    }
    before_ = after_;
    // Boxes: against a plane Bullet finds only one corner per step, and at 60 Hz a falling box tumbles.
    const auto wall = [&](const Vector3d& half, const Vector3d& middle) {
        engine_->add(std::make_unique<btBoxShape>(to_bullet(larger * half)), 0, middle, 1);
    };
    constexpr double thick = 0.1;  // m, half of a wall
    const double wide = tray.reach + 2 * thick, high = 0.3;
    wall({wide, wide, thick}, {0, 0, tray.floor - thick});
    for (const double side : {1.0, -1.0}) {
        wall({thick, wide, high}, {side * (tray.reach + thick), 0, tray.floor});
        wall({wide, thick, high}, {0, side * (tray.reach + thick), tray.floor});
    }
    for (int i = 0; i < settling; ++i) step(1e-3, {});
    dt_ = 0;
    steps_ = 0;
    first_ = before_ = after_;
}

World::~World() = default;

double World::reset() {
    const double energy = this->energy();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        btRigidBody& rigid = *engine_->rigid[i];
        const Quaterniond& q = first_[i].orientation;
        const auto turn = [](double x) { return static_cast<btScalar>(x); };
        rigid.setCenterOfMassTransform(
            btTransform(btQuaternion(turn(q.x()), turn(q.y()), turn(q.z()), turn(q.w())),
                        to_bullet(larger * first_[i].position)));
        rigid.setLinearVelocity(to_bullet(Vector3d::Zero()));
        rigid.setAngularVelocity(to_bullet(Vector3d::Zero()));
        rigid.clearForces();
    }
    before_ = after_ = first_;
    return this->energy() - energy;
}

void World::step(double dt, const std::vector<Push>& pushes, const std::vector<Pull>& pulls) {
    before_ = after_;
    pulled_ = 0;
    const int parts = parts_of(dt);
    const double part_dt = dt / parts;
    // As impulses: friction in Bullet 3.24 ignores a force's torque in the same step, so a body pressed
    // beside its middle creeps.
    const auto hit = [&](std::size_t i, const Vector3d& force, const Vector3d& lever) {
        engine_->rigid[i]->applyImpulse(to_bullet(larger * part_dt * force), to_bullet(larger * lever));
    };
    const auto lever_of = [&](std::size_t i, const Vector3d& on_body) -> Vector3d {
        return from_bullet(engine_->rigid[i]->getOrientation()) * on_body;
    };
    const auto middle_of = [&](std::size_t i) -> Vector3d {
        return from_bullet(engine_->rigid[i]->getCenterOfMassPosition()) / larger;
    };
    for (int part = 0; part < parts; ++part) {
        for (const Push& push : pushes) {
            if (!push.force.allFinite() || !push.point.allFinite()) continue;
            const Pose& then = before_[push.body];  // the point moves with the body
            hit(push.body, push.force,
                lever_of(push.body, then.orientation.conjugate() * (push.point - then.position)));
        }
        std::vector<Vector3d> forces, points;
        for (const Pull& pull : pulls) {
            const btRigidBody& body = *engine_->rigid[pull.body];
            const Vector3d lever = lever_of(pull.body, pull.on_body);
            points.push_back(middle_of(pull.body) + lever);
            const Vector3d speed = (from_bullet(body.getLinearVelocity()) +
                                    from_bullet(body.getAngularVelocity()).cross(larger * lever)) /
                                   larger;
            const Vector3d towards = pull.towards + part * part_dt * pull.velocity;
            // More damping than removes half of the speed in a part would be unstable.
            const btVector3 turns = body.getInvInertiaDiagLocal();
            const double gives = double{body.getInvMass()} +
                                 larger * larger * lever.squaredNorm() * double{turns[turns.maxAxis()]};
            const double damping =
                std::min(pull.damping, 0.5 / (static_cast<double>(pulls.size()) * gives * part_dt));
            forces.push_back(pull.stiffness * (towards - points.back()) + damping * (pull.velocity - speed));
        }
        for (std::size_t i = 0; i < pulls.size(); ++i)
            hit(pulls[i].body, forces[i], lever_of(pulls[i].body, pulls[i].on_body));
        engine_->world.stepSimulation(static_cast<btScalar>(part_dt), 0);
        for (std::size_t i = 0; i < pulls.size(); ++i)
            pulled_ += forces[i].dot(middle_of(pulls[i].body) + lever_of(pulls[i].body, pulls[i].on_body) -
                                     points[i]);
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const btTransform& place = engine_->rigid[i]->getCenterOfMassTransform();
        const Pose pose{from_bullet(place.getOrigin()) / larger, from_bullet(place.getRotation())};
        if (pose.is_one())
            after_[i] = pose;
        else if (!lost_)
            lost_ = i;
    }
    if (lost_) pulled_ = 0;
    dt_ = dt;
    ++steps_;
}

bool World::leapt(std::size_t body) const {
    const double way =
        (after_[body].position - before_[body].position).norm() +
        bodies_[body].half.norm() * after_[body].orientation.angularDistance(before_[body].orientation);
    return way > fastest * dt_;
}

void World::kick(std::size_t body, const Vector3d& velocity) {
    engine_->rigid[body]->setLinearVelocity(to_bullet(larger * velocity));
}

Vector3d World::velocity(std::size_t body) const {
    return dt_ > 0 ? Vector3d((after_[body].position - before_[body].position) / dt_) : Vector3d::Zero();
}

Vector3d World::angular_velocity(std::size_t body) const {
    return dt_ > 0 ? Vector3d(rotation_vector(before_[body].orientation, after_[body].orientation) / dt_)
                   : Vector3d::Zero();
}

Vector3d World::speed_at(std::size_t body, const Vector3d& point) const {
    const btRigidBody& rigid = *engine_->rigid[body];
    return from_bullet(rigid.getLinearVelocity()) / larger +
           from_bullet(rigid.getAngularVelocity()).cross(point - after_[body].position);
}

double World::give(std::size_t body, const Vector3d& point, const Vector3d& direction, double dt) const {
    const double parts = parts_of(dt);
    return mobility(body, point, direction) * dt * dt * (parts + 1) / (2 * parts);
}

// Contacts that only push, solved one after the other, repeatedly (projected Gauss-Seidel).
double World::mobility(std::size_t body, const Vector3d& point, const Vector3d& direction) const {
    struct Speed {
        Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();
    };
    struct Contact {
        std::size_t body[2];  // past the bodies: of the tray
        Vector3d point, normal;
        double compliance = 0, impulse = 0;
    };
    const std::size_t n = bodies_.size();
    std::vector<Speed> speeds(n + 1);
    const auto compliance = [&](std::size_t i, const Vector3d& at, const Vector3d& along) {
        if (i >= n) return 0.0;
        const btRigidBody& rigid = *engine_->rigid[i];
        const btVector3 lever = to_bullet(larger * (at - after_[i].position)).cross(to_bullet(along));
        return double{rigid.getInvMass()} + double{lever.dot(rigid.getInvInertiaTensorWorld() * lever)};
    };
    const auto hit = [&](std::size_t i, const Vector3d& at, const Vector3d& impulse) {
        if (i >= n) return;
        const btRigidBody& rigid = *engine_->rigid[i];
        const Vector3d twist = larger * (at - after_[i].position).cross(impulse);
        speeds[i].linear += double{rigid.getInvMass()} * impulse;
        speeds[i].angular += larger * from_bullet(rigid.getInvInertiaTensorWorld() * to_bullet(twist));
    };
    const auto speed = [&](std::size_t i, const Vector3d& at) -> Vector3d {
        if (i >= n) return Vector3d::Zero();
        return speeds[i].linear + speeds[i].angular.cross(at - after_[i].position);
    };
    std::map<const btCollisionObject*, std::size_t> number;
    for (std::size_t i = 0; i < n; ++i) number[engine_->rigid[i].get()] = i;
    const auto number_of = [&](const btCollisionObject* object) {
        const auto found = number.find(object);
        return found == number.end() ? n : found->second;
    };
    std::vector<Contact> contacts;
    for (int m = 0; m < engine_->dispatcher.getNumManifolds(); ++m) {
        const btPersistentManifold& manifold = *engine_->dispatcher.getManifoldByIndexInternal(m);
        for (int c = 0; c < manifold.getNumContacts(); ++c) {
            const btManifoldPoint& there = manifold.getContactPoint(c);
            if (double{there.getDistance()} > larger * touching) continue;
            Contact contact{.body = {number_of(manifold.getBody0()), number_of(manifold.getBody1())},
                            .point = from_bullet(there.getPositionWorldOnB()) / larger,
                            .normal = from_bullet(there.m_normalWorldOnB)};  // from the second to the first
            contact.compliance = compliance(contact.body[0], contact.point, contact.normal) +
                                 compliance(contact.body[1], contact.point, contact.normal);
            if (contact.compliance > 0) contacts.push_back(contact);
        }
    }
    hit(body, point, direction);
    for (int round = 0; round < mobility_rounds; ++round)
        for (Contact& c : contacts) {
            const double parting = c.normal.dot(speed(c.body[0], c.point) - speed(c.body[1], c.point));
            const double more = std::max(-c.impulse, -parting / c.compliance);
            c.impulse += more;
            hit(c.body[0], c.point, more * c.normal);
            hit(c.body[1], c.point, -more * c.normal);
        }
    return std::max(0.0, speed(body, point).dot(direction));
}

double World::energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const btRigidBody& rigid = *engine_->rigid[i];
        const Vector3d v = from_bullet(rigid.getLinearVelocity()) / larger;
        const btVector3 spin = rigid.getAngularVelocity();
        const btMatrix3x3 inertia = rigid.getInvInertiaTensorWorld().inverse();
        sum += bodies_[i].mass * (0.5 * v.squaredNorm() + gravity_ * (after_[i].position.z() - tray_.floor)) +
               0.5 * double{spin.dot(inertia * spin)} / (larger * larger);
    }
    return sum;
}

double World::distance(std::size_t body, const Vector3d& point, Vector3d* nearest) const {
    const Body& of = bodies_[body];
    const Pose& pose = after_[body];
    const Vector3d p = pose.orientation.conjugate() * (point - pose.position);
    Vector3d foot;
    double height;
    if (of.form == Body::Form::ball) {
        const double r = p.norm();
        foot = r > 0 ? Vector3d(of.half.x() / r * p) : Vector3d(0, 0, of.half.x());
        height = r - of.half.x();
    } else {
        foot = p.cwiseMax(-of.half).cwiseMin(of.half);
        height = (p - foot).norm();
        if (height == 0) {  // inside: out through the nearest face
            Eigen::Index axis = 0;
            height = -(of.half - p.cwiseAbs()).minCoeff(&axis);
            foot[axis] = p[axis] < 0 ? -of.half[axis] : of.half[axis];
        }
    }
    if (nearest) *nearest = pose.position + pose.orientation * foot;
    return height;
}

std::vector<Body> usual_bodies() {
    const double floor = Tray{}.floor;
    const auto box = [&](const char* name, const Vector3d& half, double mass, double x, double y) {
        return Body{.name = name, .half = half, .mass = mass, .position = {x, y, floor + half.z()}};
    };
    return {box("slab", {0.030, 0.025, 0.012}, 0.5, 0.045, 0),
            box("cube", {0.015, 0.015, 0.015}, 0.1, -0.02, 0.0),
            box("brick", {0.012, 0.024, 0.012}, 0.2, -0.06, 0.055),
            {.name = "ball",
             .form = Body::Form::ball,
             .half = Vector3d::Constant(0.014),
             .mass = 0.05,
             .position = {0.0, -0.06, floor + 0.014}}};
}

Skin skin_of(const Body& body) {
    Skin skin;
    // A cube of n x n squares per side, or the ball into which it is blown up. The builder of the mesh welds
    // the corners that sides share.
    const int n = body.form == Body::Form::ball ? 12 : 1;
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const double sign = side % 2 == 0 ? 1 : -1;
        const auto first = static_cast<std::uint32_t>(skin.vertices.size());
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j <= n; ++j) {
                Vector3d p;
                p[axis] = sign;
                p[(axis + 1) % 3] = sign * std::tan(M_PI / 4 * (2.0 * i / n - 1));  // evenly spaced on the
                                                                                    // ball
                p[(axis + 2) % 3] = std::tan(M_PI / 4 * (2.0 * j / n - 1));
                p = body.form == Body::Form::ball ? Vector3d(body.half.x() * p.normalized())
                                                  : Vector3d(p.cwiseProduct(body.half));
                skin.vertices.push_back({p.x(), p.y(), p.z()});
            }
        const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (n + 1) + j); };
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                skin.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                skin.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    }
    return skin;
}

}  // namespace bodies
