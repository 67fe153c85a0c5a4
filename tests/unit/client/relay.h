// A TCP relay between client and server that breaks connections as networks do.
#ifndef LATVOX_TESTS_UNIT_CLIENT_RELAY_H_
#define LATVOX_TESTS_UNIT_CLIENT_RELAY_H_

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace latvox::client {

// Listens on a port of 127.0.0.1, and passes bytes on to another port of it.
class Relay {
 public:
  explicit Relay(const std::string& server);  // "127.0.0.1:PORT"
  ~Relay();
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  const std::string& address() const { return address_; }

  // Cut resets the present connections. Freeze keeps them open, but passes no more bytes. Later connections are intact.
  void Cut() { cut_ = true; }
  void Freeze() { freeze_ = true; }

 private:
  struct Pair {
    int client, server;
    bool frozen = false;
  };

  void Run();
  void Accept();
  void Obey();
  static bool Pass(int from, int to);
  static void Reset(const Pair& pair);

  std::string address_;
  int server_port_, listener_;
  std::vector<Pair> pairs_;  // used by the thread only
  std::atomic<bool> cut_ = false, freeze_ = false, stop_ = false;
  std::thread thread_;
};

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_RELAY_H_
