// SPDX-License-Identifier: MIT
#include "protocol/transport/trace.h"

#include <stdexcept>

#include "protocol/transport/recording.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {
constexpr std::int64_t kTraceVersion = 2;
constexpr double kFlushSeconds = 0.5;
constexpr std::uint64_t kFlushFrames = 64;
}  // namespace

TraceWriter::TraceWriter(const std::string& path, const std::string& recorder, int local_rank,
                         int remote_size)
    : file_(hdf5::open_file(path, hdf5::Open::CreateForReaders)),
      frames_(Table<FrameRow>::create(file_, "frames")),
      states_(Table<State>::create(file_, "states")),
      shapes_(Table<Shape>::create(file_, "shapes")),
      loads_(Table<Load>::create(file_, "loads")),
      bytes_(Table<std::byte>::create(file_, "bytes")),
      start_(std::chrono::steady_clock::now()),
      flushed_(start_) {
  hdf5::set_attribute(file_, "trace_version", kTraceVersion);
  hdf5::set_attribute(file_, "recorder", recorder);
  hdf5::set_attribute(file_, "local_rank", std::int64_t{local_rank});
  hdf5::set_attribute(file_, "remote_size", std::int64_t{remote_size});
  hdf5::check(H5Fstart_swmr_write(file_), "make a trace readable while it is written");
}

TraceWriter::~TraceWriter() {
  try {
    flush();
  } catch (const std::exception& e) {
    print(stderr, "trace: the last rows are lost: {}\n", e.what());
  }
}

void TraceWriter::record(Direction direction, int remote, const Bytes& frame) {
  FrameRow row;
  row.direction = direction;
  row.remote = remote;
  row.kind = kind_of(frame);
  const auto now = std::chrono::steady_clock::now();
  row.wall_clock = std::chrono::duration<double>(now - start_).count();
  const auto set_header = [&row](const StepHeader& head) {
    row.interval = head.interval;
    row.time = head.time;
    row.flags = head.flags;
  };
  if (row.kind == Kind::States) {
    const auto batch = decode<StateBatch>(frame);
    set_header(batch.head);
    row.setting = batch.setting;
    row.first = states_.size();
    row.count = batch.states.size();
    row.shape_first = shapes_.size();
    row.shape_count = batch.shapes.size();
    states_.append(batch.states);
    shapes_.append(batch.shapes);
  } else if (row.kind == Kind::Loads) {
    const auto batch = decode<LoadBatch>(frame);
    set_header(batch.head);
    row.first = loads_.size();
    row.count = batch.loads.size();
    loads_.append(batch.loads);
  } else {
    row.first = bytes_.size();
    row.count = frame.size();
    bytes_.append(frame);
  }
  frames_.append({&row, 1});
  if (frames_.size() % kFlushFrames == 0 ||
      std::chrono::duration<double>(now - flushed_).count() > kFlushSeconds)
    flush();
}

void TraceWriter::flush() {
  bytes_.flush();  // records before the frames that point at them
  states_.flush();
  shapes_.flush();
  loads_.flush();
  frames_.flush();
  flushed_ = std::chrono::steady_clock::now();
}

Trace::Trace(const std::string& path) {
  const hdf5::Handle file = hdf5::open_file(path, hdf5::Open::ReadWhileWritten);
  std::int64_t version = 0;
  try {
    version = hdf5::integer_attribute(file, "trace_version");
  } catch (const std::exception&) {
    throw std::runtime_error(path + " is an HDF5 file but no trace of this program");
  }
  if (version != kTraceVersion)
    throw std::runtime_error(
        format("{} has trace version {}, this program reads {}", path, version, kTraceVersion));
  recorder_ = hdf5::text_attribute(file, "recorder");
  local_rank_ = static_cast<int>(hdf5::integer_attribute(file, "local_rank"));
  remote_size_ = static_cast<int>(hdf5::integer_attribute(file, "remote_size"));
  frames_ =
      Table<FrameRow>::open(file, "frames").read_all();  // first: its records lie there already
  states_ = Table<State>::open(file, "states").read_all();
  shapes_ = Table<Shape>::open(file, "shapes").read_all();
  loads_ = Table<Load>::open(file, "loads").read_all();
  bytes_ = Table<std::byte>::open(file, "bytes").read_all();
  for (const FrameRow& row : frames_) {
    const std::uint64_t size = row.kind == Kind::States  ? states_.size()
                               : row.kind == Kind::Loads ? loads_.size()
                                                         : bytes_.size();
    if (row.first > size || row.count > size - row.first || row.shape_first > shapes_.size() ||
        row.shape_count > shapes_.size() - row.shape_first || row.remote < 0 ||
        row.remote >= remote_size_)
      throw std::runtime_error(path + " is damaged: a frame points beyond its table");
  }
}

std::span<const State> Trace::states(const FrameRow& row) const {
  return std::span(states_).subspan(row.first, row.count);
}
std::span<const Shape> Trace::shapes(const FrameRow& row) const {
  return std::span(shapes_).subspan(row.shape_first, row.shape_count);
}
std::span<const Load> Trace::loads(const FrameRow& row) const {
  return std::span(loads_).subspan(row.first, row.count);
}

Bytes Trace::frame(const FrameRow& row) const {
  if (row.kind == Kind::States) {
    const auto s = states(row);
    const auto h = shapes(row);
    return encode(
        StateBatch{header(row), row.setting, {s.begin(), s.end()}, {h.begin(), h.end()}, {}});
  }
  if (row.kind == Kind::Loads) {
    const auto l = loads(row);
    return encode(LoadBatch{header(row), {l.begin(), l.end()}});
  }
  const auto b = std::span(bytes_).subspan(row.first, row.count);
  return {b.begin(), b.end()};
}

Hello Trace::hello(Role role) const {
  for (const FrameRow& row : frames_)
    if (row.kind == Kind::Hello) {
      const auto hello = decode<Hello>(frame(row));
      if (hello.role == role) return hello;
    }
  throw std::runtime_error("the recording ended before the handshake of both sides");
}

namespace {

class RecordingChannel final : public Channel {
 public:
  RecordingChannel(std::unique_ptr<Channel> inner, std::unique_ptr<TraceWriter> writer)
      : inner_(std::move(inner)), writer_(std::move(writer)) {}

  int local_rank() const override { return inner_->local_rank(); }
  int remote_size() const override { return inner_->remote_size(); }
  std::string remote_name() const override { return inner_->remote_name(); }

  void send(int remote, Bytes frame, const Wait& wait) override {
    writer_->record(Direction::Sent, remote, frame);
    guarded([&] { inner_->send(remote, std::move(frame), wait); });
  }
  Bytes receive(int remote, const Wait& wait) override {
    Bytes frame;
    guarded([&] { frame = inner_->receive(remote, wait); });
    writer_->record(Direction::Received, remote, frame);
    return frame;
  }
  void raise(const Fault& fault) noexcept override {
    try {
      for (int r = 0; r < remote_size(); ++r) writer_->record(Direction::Sent, r, encode(fault));
      writer_->flush();
    } catch (...) {  // the fault matters more than its record
    }
    inner_->raise(fault);
  }
  Ending await_farewell(double seconds) noexcept override {
    return inner_->await_farewell(seconds);
  }
  void say_farewell() noexcept override { inner_->say_farewell(); }

 private:
  template <class Call>
  void guarded(Call&& call) {
    try {
      call();
    } catch (const PeerFault& fault) {
      writer_->record(Direction::Received, 0, encode(Fault{fault.exit_code(), fault.what()}));
      writer_->flush();
      throw;
    }
  }
  std::unique_ptr<Channel> inner_;
  std::unique_ptr<TraceWriter> writer_;
};

class ReplayChannel final : public Channel {
 public:
  explicit ReplayChannel(std::shared_ptr<const Trace> trace)
      : trace_(std::move(trace)), received_(trace_->remote_size()), sent_(trace_->remote_size()) {
    for (const FrameRow& row : trace_->frames())
      (row.direction == Direction::Sent ? sent_ : received_)[row.remote].push_back(&row);
  }

  int local_rank() const override { return trace_->local_rank(); }
  int remote_size() const override { return trace_->remote_size(); }
  std::string remote_name() const override {
    return trace_->recorder() == "fluid" ? "recorded solid" : "recorded fluid";
  }

  void send(int remote, Bytes frame, const Wait& wait) override {
    const FrameRow& row = next(sent_[remote], remote, wait);
    if (row.kind == Kind::Hello || frame == trace_->frame(row)) return;  // handshakes hold versions
    throw ProtocolError(
        format("interval {}: the {} message sent to {} differs from the "
               "recorded one; `trace diff` names the first difference",
               row.interval, name(kind_of(frame)), remote_name()));
  }
  Bytes receive(int remote, const Wait& wait) override {
    const Bytes frame = trace_->frame(next(received_[remote], remote, wait));
    if (kind_of(frame) == Kind::Fault) throw PeerFault(decode<Fault>(frame));
    return frame;
  }
  void raise(const Fault&) noexcept override {}
  Ending await_farewell(double) noexcept override { return {}; }
  void say_farewell() noexcept override {}

 private:
  const FrameRow& next(std::deque<const FrameRow*>& rows, int remote, const Wait& wait) {
    if (rows.empty())
      throw Timeout(timeout_text(*this, remote, wait) + ": the recording ends here");
    const FrameRow& row = *rows.front();
    rows.pop_front();
    return row;
  }
  std::shared_ptr<const Trace> trace_;
  std::vector<std::deque<const FrameRow*>> received_, sent_;
};

}  // namespace

std::unique_ptr<Channel> make_recording_channel(std::unique_ptr<Channel> inner,
                                                std::unique_ptr<TraceWriter> writer) {
  return std::make_unique<RecordingChannel>(std::move(inner), std::move(writer));
}

void record_to(const std::string& file, std::unique_ptr<Channel>& channel,
               const std::string& recorder, int local_rank, const Bytes& received) {
  const int remotes = channel->remote_size();
  auto writer = std::make_unique<TraceWriter>(file, recorder, local_rank, remotes);
  for (int r = 0; r < remotes && !received.empty(); ++r)
    writer->record(Direction::Received, r, received);
  channel = make_recording_channel(std::move(channel), std::move(writer));
}

std::unique_ptr<Channel> make_replay_channel(std::shared_ptr<const Trace> trace) {
  return std::make_unique<ReplayChannel>(std::move(trace));
}

}  // namespace protocol
