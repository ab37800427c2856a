#include "core/run/remote_batches.h"

#include <chrono>
#include <iostream>
#include <thread>

#include "core/byte_stream.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/run/stopwatch.h"

namespace flatspeckle {

namespace {

/// A rank begins with one greeting; then each of its threads asks again and again, with the batch
/// that it has done, if any.
struct Request {
  enum Kind : std::uint32_t { greeting, first, delivery, interrupted } kind = first;
  std::uint32_t threads = 0;
  std::uint64_t run = 0, number = 0;
  double cpu_s = 0;
  // sums follow, of a delivery
};

struct Reply {
  BatchPool::Offer offer = BatchPool::Offer::none;
  std::uint64_t run = 0, number = 0;
};

Bytes message_of(const Request& request, const std::vector<Complex>& sums = {}) {
  ByteWriter message;
  message.put(request);
  message.put(sums);
  return message.take();
}

Reply asked(const Request& request, const std::vector<Complex>& sums = {}) {
  return ByteReader(ask(message_of(request, sums))).get<Reply>();
}

/// The jobs that this rank works on, made when first needed.
class Jobs {
 public:
  explicit Jobs(const RunList& runs) : runs_(runs) {}

  std::shared_ptr<const BatchJob> get(std::size_t run) {
    const std::lock_guard lock(mutex_);
    auto& job = jobs_[run];
    if (!job) {
      constexpr std::size_t most = 16;
      job = std::make_shared<const BatchJob>(runs_.job(run));
      order_.push_back(run);
      if (order_.size() > most) {
        jobs_.erase(order_.front());
        order_.erase(order_.begin());
      }
    }
    return jobs_.at(run);
  }

 private:
  const RunList& runs_;
  std::mutex mutex_;
  std::map<std::size_t, std::shared_ptr<const BatchJob>> jobs_;
  std::vector<std::size_t> order_;
};

/// One thread of another rank.
void work_remotely(Jobs& jobs) {
  using Offer = BatchPool::Offer;
  double cpu_before = thread_cpu_seconds();
  auto reply = asked({});
  while (reply.offer != Offer::none) {
    if (reply.offer == Offer::later) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      reply = asked({});
      continue;
    }
    std::vector<Complex> sums;
    try {
      const auto job = jobs.get(reply.run);
      sums.resize(job->size);
      job->run(reply.number, sums);
    } catch (const Interrupted&) {
      reply = asked({Request::interrupted});
      continue;
    }
    const double cpu_now = thread_cpu_seconds();
    const Request done{Request::delivery, 0, reply.run, reply.number, cpu_now - cpu_before};
    cpu_before = cpu_now;
    reply = asked(done, sums);
  }
}

}  // namespace

void RankServer::serve(BatchPool* pool) {
  if (silent_ranks_ < 0) silent_ranks_ = ranks().size - 1;
  while (silent_ranks_ > 0 || threads_ > 0) {
    if (const auto message = next_message())
      take_in(pool, message->from, message->bytes);
    else
      std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
}

void RankServer::take_in(BatchPool* pool, int rank, const Bytes& message) {
  ByteReader bytes(message);
  const auto request = bytes.get<Request>();
  Reply reply;
  if (request.kind == Request::greeting) {
    --silent_ranks_;
    threads_ += static_cast<int>(request.threads);
  } else if (pool != nullptr) {
    try {
      if (request.kind == Request::interrupted)
        pool->interrupt();
      else if (request.kind == Request::delivery)
        pool->deliver({request.run, request.number, nullptr}, bytes.get<std::vector<Complex>>(),
                      request.cpu_s);
    } catch (...) {
      pool->fail(std::current_exception());
    }
    BatchPool::Batch batch;
    reply.offer = pool->offer(rank, batch);
    reply.run = batch.run;
    reply.number = batch.number;
  }
  if (request.kind != Request::greeting && reply.offer == BatchPool::Offer::none) --threads_;
  answer(rank, std::as_bytes(std::span(&reply, 1)));
}

void work_for_rank_0(const RunList& runs, int threads) {
  Jobs jobs(runs);
  ask(message_of({Request::greeting, static_cast<std::uint32_t>(threads)}));
#pragma omp parallel num_threads(threads)
  try {
    work_remotely(jobs);
  } catch (const std::exception& error) {
    std::cerr << "flatspeckle: process " << ranks().rank << ": " << error.what() << '\n';
    abort_ranks(1);
  }
}

}  // namespace flatspeckle
