#include <knurl/client/client.hpp>

#include "claim_state.hpp"
#include "client_state.hpp"
#include "reader.hpp"
#include "sending_state.hpp"

namespace knurl {

namespace {

double seconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double>(time).count();
}

void require_range(const char* what, std::uint32_t value, std::uint32_t most) {
    if (value < 1 || value > most)
        throw Error(Error::Kind::bad_parameters, std::string("claim: ") + what + " = " +
                                                     std::to_string(value) + "; give 1 to " +
                                                     std::to_string(most));
}

protocol::ClaimRequest request_of(const ClaimOptions& options) {
    require_range("representations", options.representations, protocol::max_representations);
    if (!(options.workspace_radius >= 0 && options.workspace_radius < 1e6))
        throw Error(Error::Kind::bad_parameters,
                    "claim: workspace_radius = " + std::to_string(options.workspace_radius) +
                        " m; give the radius of the application's world, or 0 for the device's own");
    if (!to_eigen(options.workspace_centre).allFinite())
        throw Error(Error::Kind::bad_parameters, "claim: workspace_centre is not finite; give metres");
    if (options.update_interval.count() < 0)
        throw Error(Error::Kind::bad_parameters,
                    "claim: update_interval is below 0; give a time, or 0 for measured");
    protocol::ClaimRequest request;
    request.shared = options.shared ? 1 : 0;
    request.capacity = {.representations = options.representations,
                        .batch_bytes = protocol::batch_bytes_for(options.representations)};
    request.workspace_radius = options.workspace_radius;
    request.workspace_centre = options.workspace_centre;
    request.update_interval = seconds(options.update_interval);
    return request;
}

Sending sending(const std::shared_ptr<detail::ClaimState>& claim, detail::AssetMemory source) {
    auto [number, transfer] = claim->begin_sending(std::move(source));
    return Sending(std::make_shared<detail::SendingState>(claim, number, std::move(transfer)));
}

SentShape sent(Sending sending) {
    for (;;)
        if (const std::optional<SentShape> sent = sending.done(std::chrono::hours(1))) return *sent;
}

}  // namespace

Observer::Observer(std::shared_ptr<detail::Reader> reader) : reader_(std::move(reader)) {}
std::optional<HandReport> Observer::latest() {
    return reader_->latest();
}
std::optional<HandReport> Observer::next_report(std::chrono::nanoseconds timeout) {
    return reader_->next_report(timeout);
}
std::optional<HandFrame> Observer::newest(std::chrono::nanoseconds timeout) {
    return reader_->newest(timeout);
}
std::size_t Observer::drain(std::span<HandReport> out) {
    return reader_->drain(reinterpret_cast<std::byte*>(out.data()), sizeof(HandReport), out.size());
}
std::size_t Observer::drain_rows(std::byte* first, std::size_t stride, std::size_t most) {
    return reader_->drain(first, stride, most);
}
int Observer::fd() {
    return reader_->fd();
}
std::uint64_t Observer::missed() const {
    return reader_->missed();
}
DeviceDescription Observer::device() const {
    return reader_->description();
}
Age Observer::age(const Report& report) const {
    return reader_->age(report);
}
Network Observer::network() const {
    return reader_->network();
}
void Observer::release() {
    reader_->close();
}
bool Observer::connected() const {
    return reader_->connected();
}
std::uint64_t Observer::reattachments() const {
    return reader_->reattachments();
}

Claim::Claim(std::shared_ptr<detail::ClaimState> state) : Observer(state), state_(std::move(state)) {}

Claim& Claim::operator=(Claim&& other) noexcept {
    if (this != &other) {
        if (state_) state_->close();
        state_ = std::move(other.state_);  // before the base takes its part: `other` is whole until then
        Observer::operator=(std::move(other));
    }
    return *this;
}

Claim::~Claim() {
    if (state_) state_->close();  // handles may live on
}

RepresentationId Claim::add_raw(Kind kind, const void* params, std::size_t bytes, const AddOptions& options) {
    return state_->add(kind, params, bytes, options);
}
void Claim::together(const std::function<void()>& changes) {
    state_->together(changes);
}
void Claim::begin_group() {
    state_->begin_group();
}
void Claim::end_group() {
    state_->end_group();
}
void Claim::cancel_group() {
    state_->cancel_group();
}
AnyHandle Claim::add_bytes(Kind kind, std::span<const std::byte> params, const AddOptions& options) {
    return {state_, add_raw(kind, params.data(), params.size(), options), kind};
}
void Claim::keep_alive() {
    state_->keep_alive();
}
void Claim::place_probe(std::uint32_t probe, const ProbePlacement& placement) {
    state_->place_probe(probe, placement);
}
Sending Claim::begin_sending(const Triangles& mesh, const SendOptions& options) {
    return sending(state_, detail::source_of(mesh, options));
}
Sending Claim::begin_sending(const Heights& field) {
    return sending(state_, detail::source_of(field));
}
SentShape Claim::send(const Triangles& mesh, const SendOptions& options) {
    return sent(begin_sending(mesh, options));
}
SentShape Claim::send(const Heights& field) {
    return sent(begin_sending(field));
}
void Claim::forget(std::uint32_t asset) {
    state_->forget(asset);
}

Sending::Sending(std::shared_ptr<detail::SendingState> state) : state_(std::move(state)) {}
Sending::~Sending() = default;
std::optional<SentShape> Sending::done(std::chrono::nanoseconds wait) {
    return state_->done(wait);
}
int Sending::fd() const {
    return state_->fd();
}

void Claim::arm() {
    state_->ask(protocol::CommandType::arm);
}
void Claim::disarm() {
    state_->ask(protocol::CommandType::disarm);
}
void Claim::reset_fault() {
    state_->ask(protocol::CommandType::reset_fault);
}
std::uint64_t Claim::commit() {
    return state_->commit();
}
Limits Claim::limits() const {
    return state_->limits();
}
Timing Claim::timing() const {
    return state_->timing();
}
Vec3 Claim::predicted_position() {
    return state_->predicted_position();
}
bool Claim::wait_applied(std::uint64_t number, std::chrono::nanoseconds timeout) {
    return state_->wait_applied(number, timeout);
}

void AnyHandle::remove() {
    state_->remove(id_);
}
std::optional<HandFeedback> AnyHandle::feedback() const {
    return state_->feedback(id_);
}
std::optional<double> AnyHandle::applied_stiffness() const {
    return state_->applied_stiffness(id_);
}
void AnyHandle::set_bytes(std::span<const std::byte> params) {
    state_->set(id_, kind_, params.data(), params.size());
}
void AnyHandle::get_bytes(std::span<std::byte> params) const {
    state_->get(id_, kind_, params);
}
Followed AnyHandle::follow_model(const SurfaceModel& model) {
    return state_->follow(id_, kind_, model);
}

Client::Client(std::shared_ptr<detail::ClientState> state) : state_(std::move(state)) {}

Client Client::connect(const std::string& address, const ConnectOptions& options) {
    if (!(options.report_rate >= 0 && options.report_rate <= 1e6))
        throw Error(Error::Kind::bad_parameters,
                    "connect: report_rate = " + std::to_string(options.report_rate) +
                        " Hz; give up to 1e6, or 0 for every report");
    return Client(detail::make_own<detail::ClientState>(address, options));
}

std::vector<DeviceDescription> Client::devices() const {
    return state_->devices();
}
pid_t Client::servo_pid() const {
    return state_->servo_pid();
}
bool Client::connected() const {
    return state_->connected();
}

Claim Client::claim(const std::string& device, const ClaimOptions& options) {
    auto state = detail::make_own<detail::ClaimState>(state_, state_->resolve(device), request_of(options));
    state_->join(*state);
    return Claim(std::move(state));
}

void Client::reset_fault(const std::string& device) {
    protocol::ClaimRequest request;
    request.observe = protocol::observe_and_reset;
    auto state = detail::make_own<detail::ClaimState>(state_, state_->resolve(device), request);
    state_->join(*state);
    Claim(std::move(state)).reset_fault();
}

Observer Client::observe(const std::string& device) {
    protocol::ClaimRequest request;
    request.observe = 1;
    auto reader = detail::make_own<detail::Reader>(state_, state_->resolve(device), request);
    state_->join(*reader);
    return Observer(std::move(reader));
}

}  // namespace knurl
