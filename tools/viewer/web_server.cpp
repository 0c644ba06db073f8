#include "tools/viewer/web_server.hpp"

#include <sys/random.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <wslay/wslay.h>

#include <algorithm>
#include <array>
#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/basic_parser.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/status.hpp>
#include <boost/beast/http/verb.hpp>
#include <boost/beast/websocket/detail/hybi13.hpp>
#include <boost/optional/optional.hpp>
#include <chrono>
#include <map>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "configs/errors/exit_code.hpp"

namespace wade::view {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using Clock = std::chrono::steady_clock;
using Error = boost::system::error_code;
using Text = boost::beast::string_view;
using Tcp = asio::ip::tcp;
// With the executor of io_context, as the type-erased default executor takes longer to compile.
using Acceptor = asio::basic_socket_acceptor<Tcp, asio::io_context::executor_type>;
using Socket = asio::basic_stream_socket<Tcp, asio::io_context::executor_type>;

constexpr std::size_t most_clients = 24;
constexpr std::size_t most_question_bytes = 4096;
constexpr auto patience = std::chrono::seconds(15);
constexpr auto most_silence = std::chrono::seconds(60);  // of a client, with a ping after half of it
constexpr auto most_closing = std::chrono::seconds(30);

// Parses a request without a body and keeps what the server needs of it. The first of two fields with the same name counts.
class Request : public http::basic_parser<true> {
 public:
    Request() {
        eager(true);
        header_limit(8192);
        body_limit(0);
    }

    [[nodiscard]] http::verb method() const { return method_; }
    [[nodiscard]] const std::string& target() const { return target_; }
    [[nodiscard]] bool is_old() const { return version_ < 11; }
    [[nodiscard]] bool has(http::field name) const { return fields_.contains(name); }
    [[nodiscard]] std::string operator[](http::field name) const {
        const auto found = fields_.find(name);
        return found == fields_.end() ? "" : found->second;
    }
    [[nodiscard]] bool asks_for_websocket() const {
        return !is_old() && method_ == http::verb::get && upgrade() &&
               http::token_list((*this)[http::field::upgrade]).exists("websocket");
    }

 private:
    void on_request_impl(http::verb method, Text, Text target, int version, Error&) override {
        method_ = method;
        target_.assign(target.data(), target.size());
        version_ = version;
    }
    void on_field_impl(http::field name, Text, Text value, Error&) override {
        fields_.emplace(name, std::string(value.data(), value.size()));
    }
    std::size_t on_body_impl(Text, Error& error) override {
        error = http::error::unexpected_body;
        return 0;
    }
    std::size_t on_chunk_body_impl(std::uint64_t, Text text, Error& error) override {
        return on_body_impl(text, error);
    }
    void on_response_impl(int, Text, int, Error&) override {}
    void on_header_impl(Error&) override {}
    void on_body_init_impl(const boost::optional<std::uint64_t>&, Error&) override {}
    void on_chunk_header_impl(std::uint64_t, Text, Error&) override {}
    void on_finish_impl(Error&) override {}

    http::verb method_ = http::verb::unknown;
    std::string target_;
    int version_ = 0;
    std::map<http::field, std::string> fields_;
};

// Pages of other sites, and names that lead here by a trick of DNS, get nothing.
bool is_from_here(const Request& request, std::uint16_t port) {
    const std::string number = ":" + std::to_string(port);
    const std::string host = request[http::field::host], origin = request[http::field::origin];
    const bool known = host == "127.0.0.1" + number || host == "localhost" + number;
    return known && (origin.empty() || origin == "http://" + host);
}

// 128 random bits as hexadecimal digits.
std::string random_key() {
    std::array<unsigned char, 16> bytes;
    if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
        throw ConfigurationError("no random numbers for the key of the page.");
    std::string key;
    for (const unsigned char byte : bytes)
        for (const int digit : {byte >> 4, byte & 15}) key += "0123456789abcdef"[digit];
    return key;
}

// Compares texts in a time that does not depend on where they differ.
bool is_equal(std::string_view a, std::string_view b) {
    unsigned char difference = a.size() == b.size() ? 0 : 1;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
        difference = static_cast<unsigned char>(difference | (a[k] ^ b[k]));
    return difference == 0;
}

// Browsers send cookies to all ports of a host, so that the name of this one holds the port.
std::string cookie_name(std::uint16_t port) {
    return "wade_" + std::to_string(port);
}

// Whether the cookies of a request, "name=value; name=value", hold the key.
bool has_key(std::string_view cookies, std::uint16_t port, std::string_view key) {
    const std::string wanted = cookie_name(port) + "=";
    while (!cookies.empty()) {
        const std::size_t end = std::min(cookies.find(';'), cookies.size());
        std::string_view one = cookies.substr(0, end);
        one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
        if (one.starts_with(wanted) && is_equal(one.substr(wanted.size()), key)) return true;
        cookies.remove_prefix(std::min(end + 1, cookies.size()));
    }
    return false;
}

// Leads to the page without the key in the address, from the same site, so that a strict cookie is sent along.
constexpr const char* page_behind_key =
    "<!doctype html><meta charset=\"utf-8\"><title>Wade</title>"
    "<script>location.replace('/' + location.hash)</script>\n";

class Peer;
using Peers = std::set<std::shared_ptr<Peer>>;

struct Server {
    Server(std::uint16_t wanted, const Pages& pages) : acceptor(context), site(pages) {
        const Tcp::endpoint place(asio::ip::address_v4::loopback(), wanted);
        Error error;
        acceptor.open(place.protocol(), error);
        acceptor.set_option(asio::socket_base::reuse_address(true), error);
        acceptor.bind(place, error);
        if (!error) acceptor.listen(64, error);
        if (!error) acceptor.non_blocking(true, error);
        if (error)
            throw ConfigurationError("--port " + std::to_string(wanted) + ": " + error.message() +
                                     "; allowed: a free port, 0 takes one.");
        port = acceptor.local_endpoint().port();
    }

    void accept();
    bool tick();

    asio::io_context context{1};
    Acceptor acceptor;
    const Pages& site;
    std::uint16_t port = 0;
    const std::string key = random_key();
    Peers connections, clients;  // of HTTP and of the WebSocket
    unsigned ticks = 0;
};

// A TCP connection, an element of `peers` until it is closed. The peer waits until the socket is readable or writable and then
// reads or writes without blocking, so that one asynchronous operation of Asio is compiled.
class Peer : public std::enable_shared_from_this<Peer> {
 public:
    Peer(Socket socket, Server& server, Peers& peers) : socket_(std::move(socket)), server_(server), peers_(peers) {}
    virtual ~Peer() = default;
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    void start(Socket::wait_type what) {
        peers_.insert(shared_from_this());
        close_after(patience);
        wait(what);
    }
    // Closes the peer after its deadline. `status` is the text for clients, empty between two of them.
    virtual void tick(const std::string& /*status*/) {
        if (time_left() < Clock::duration::zero()) close();
    }
    [[nodiscard]] Clock::duration time_left() const { return deadline_ - Clock::now(); }
    void close() {
        Error ignored;
        socket_.close(ignored);
        leave();
    }

 protected:
    virtual void read() = 0;
    virtual void write() = 0;

    void wait(Socket::wait_type what) {
        if (std::exchange(is_waiting_.at(what), true)) return;
        socket_.async_wait(what, [self = shared_from_this(), what](Error error) {
            self->is_waiting_.at(what) = false;
            if (error) return;  // closed
            if (what == Socket::wait_read) {
                self->read();
            } else {
                self->write();
            }
        });
    }
    void close_after(Clock::duration time) { deadline_ = Clock::now() + time; }
    void leave() { peers_.erase(shared_from_this()); }

    Socket socket_;
    Server& server_;

 private:
    Peers& peers_;
    std::array<bool, 2> is_waiting_{};  // wait_read, wait_write
    Clock::time_point deadline_;
};

// A connection of the WebSocket. wslay makes and parses its frames and answers pings and close frames.
class Client : public Peer {
 public:
    // `handshake` is the response to the request for the WebSocket.
    Client(Socket socket, Server& server, std::string handshake);

    void tick(const std::string& status) override;

 private:
    void read() override;
    void write() override;
    void take(bool is_text, const std::string& message);
    void send_status(const std::string& text);
    void send_what_is_ready();
    bool queue_next();
    void queue(wslay_opcode kind, const std::string& bytes);
    ssize_t result(std::size_t count, Error error);

    std::string handshake_;  // the part that is not sent yet
    std::unique_ptr<wslay_event_context, decltype(&wslay_event_context_free)> stream_{nullptr,
                                                                                      wslay_event_context_free};
    std::span<const std::uint8_t> bytes_;                                  // read from the socket, for wslay
    std::map<std::pair<std::string, std::uint32_t>, Question> questions_;  // by kind and slot
    bool is_open_ = true, is_pinged_ = false, has_new_status_ = false;
    std::string status_;
};

// A connection of HTTP. Becomes a client at a request for the stream.
class Connection : public Peer {
 public:
    Connection(Socket socket, Server& server) : Peer(std::move(socket), server, server.connections) {
        expect_request();
    }

 private:
    void expect_request() {
        request_.emplace();
        close_after(patience);
    }

    void read() override {
        std::array<char, 16384> bytes;  // more than a request may have, as unread bytes would reset the connection
        Error error;
        const std::size_t count = socket_.read_some(asio::buffer(bytes), error);
        if (error == asio::error::would_block) return wait(Socket::wait_read);
        if (error) return close();
        received_.append(bytes.data(), count);
        parse();
    }

    void parse() {
        Error error;
        if (!received_.empty()) received_.erase(0, request_->put(asio::buffer(received_), error));
        if (error && error != http::error::need_more) return close();  // too long, or no HTTP
        if (request_->is_done()) return answer(*request_);
        wait(Socket::wait_read);
    }

    void answer(const Request& request) {
        if (!is_from_here(request, server_.port)) return send(http::status::forbidden, {"text/plain", "no\n"});
        const std::string& target = request.target();
        if (target.starts_with("/?key=") && is_equal(target.substr(6), server_.key))
            return send(http::status::ok, {"text/html; charset=utf-8", page_behind_key},
                        "Set-Cookie: " + cookie_name(server_.port) + "=" + server_.key +
                            "; HttpOnly; SameSite=Strict; Path=/\r\n");
        if (!has_key(request[http::field::cookie], server_.port, server_.key))
            return send(http::status::forbidden,
                        {"text/plain", "Open the page by the file that tools/wade view has named.\n"});
        if (request.asks_for_websocket()) return upgrade(request);
        if (request.method() != http::verb::get && request.method() != http::verb::head)
            return send(http::status::method_not_allowed, {"text/plain", "only GET\n"});
        const std::optional<WebFile> file = server_.site.file(target.substr(0, target.find('?')));
        if (!file) return send(http::status::not_found, {"text/plain", "there is no such file\n"});
        send(http::status::ok, *file);
    }

    void upgrade(const Request& request) {
        if (request.target() != "/stream") return send(http::status::not_found, {"text/plain", "no\n"});
        if (server_.clients.size() >= most_clients)
            return send(http::status::service_unavailable, {"text/plain", "too many pages are open\n"});
        // RFC 6455, section 4.2.1.
        const auto refuse = [&](http::status status, const std::string& reason) {
            send(status, {"text/plain", "The WebSocket handshake Sec-WebSocket-" + reason},
                 "Sec-WebSocket-Version: 13\r\n");
        };
        const std::string key = request[http::field::sec_websocket_key];
        if (!request.has(http::field::sec_websocket_key))
            return refuse(http::status::bad_request, "Key field is missing");
        if (key.size() > websocket::detail::sec_ws_key_type::max_size_n)
            return refuse(http::status::bad_request, "Key field is invalid");
        if (!request.has(http::field::sec_websocket_version))
            return refuse(http::status::bad_request, "Version field is missing");
        if (request[http::field::sec_websocket_version] != "13")
            return refuse(http::status::upgrade_required, "Version field is invalid");

        websocket::detail::sec_ws_accept_type accepted;
        websocket::detail::make_sec_ws_accept(accepted, key);
        std::string handshake = "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: upgrade\r\n";
        handshake.append("Sec-WebSocket-Accept: ").append(accepted.data(), accepted.size()).append("\r\n\r\n");
        std::make_shared<Client>(std::move(socket_), server_, std::move(handshake))->start(Socket::wait_write);
        leave();
    }

    void send(http::status status, const WebFile& file, std::string_view fields = "") {
        const bool is_old = request_->is_old(), stays = request_->keep_alive();
        const Text reason = http::obsolete_reason(status);
        response_ = is_old ? "HTTP/1.0 " : "HTTP/1.1 ";
        response_ += std::to_string(static_cast<unsigned>(status));
        response_.append(" ").append(reason.data(), reason.size()).append("\r\nContent-Type: ").append(file.type);
        response_ +=
            "\r\nCache-Control: no-cache\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
            "Content-Security-Policy: frame-ancestors 'none'; base-uri 'none'; form-action 'none'; default-src 'self'; "
            "script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
            "img-src 'self' data: blob:\r\n";
        response_ += fields;
        if (stays == is_old) response_ += stays ? "Connection: keep-alive\r\n" : "Connection: close\r\n";
        response_.append("Content-Length: ").append(std::to_string(file.body.size())).append("\r\n\r\n");
        if (request_->method() != http::verb::head) response_ += file.body;
        sent_ = 0;
        close_after(patience);
        wait(Socket::wait_write);
    }

    void write() override {
        Error error;
        sent_ += socket_.write_some(asio::buffer(response_) + sent_, error);
        if (error && error != asio::error::would_block) return close();
        if (sent_ < response_.size()) return wait(Socket::wait_write);
        if (!request_->keep_alive()) return close();
        expect_request();
        parse();
    }

    std::optional<Request> request_;
    std::string received_;  // the part that is not parsed yet
    std::string response_;
    std::size_t sent_ = 0;  // bytes of the response
};

Client::Client(Socket socket, Server& server, std::string handshake)
    : Peer(std::move(socket), server, server.clients), handshake_(std::move(handshake)) {
    wslay_event_callbacks calls{};
    calls.recv_callback = [](wslay_event_context_ptr, std::uint8_t* to, std::size_t room, int, void* client) {
        auto& self = *static_cast<Client*>(client);
        const std::size_t count = std::min(room, self.bytes_.size());
        std::copy_n(self.bytes_.begin(), count, to);
        self.bytes_ = self.bytes_.subspan(count);
        return self.result(count, asio::error::would_block);
    };
    calls.send_callback = [](wslay_event_context_ptr, const std::uint8_t* from, std::size_t count, int flags,
                             void* client) {
        auto& self = *static_cast<Client*>(client);
        Error error;
        const int more = (flags & WSLAY_MSG_MORE) != 0 ? MSG_MORE : 0;
        const std::size_t sent = self.socket_.send(asio::buffer(from, count), more, error);
        return self.result(sent, error);
    };
    calls.on_msg_recv_callback = [](wslay_event_context_ptr, const wslay_event_on_msg_recv_arg* got, void* client) {
        if (wslay_is_ctrl_frame(got->opcode)) return;
        const std::string message(got->msg, got->msg + got->msg_length);
        static_cast<Client*>(client)->take(got->opcode == WSLAY_TEXT_FRAME, message);
    };
    wslay_event_context_ptr stream = nullptr;
    if (wslay_event_context_server_init(&stream, &calls, this) != 0) throw std::bad_alloc();
    stream_.reset(stream);
    wslay_event_config_set_max_recv_msg_length(stream, most_question_bytes);
}

// Returns what a callback of wslay has to return after it moved `count` bytes.
ssize_t Client::result(std::size_t count, Error error) {
    if (count > 0) return static_cast<ssize_t>(count);
    wslay_event_set_error(stream_.get(),
                          error == asio::error::would_block ? WSLAY_ERR_WOULDBLOCK : WSLAY_ERR_CALLBACK_FAILURE);
    return -1;
}

void Client::write() {
    if (handshake_.empty()) return send_what_is_ready();
    Error error;
    handshake_.erase(0, socket_.write_some(asio::buffer(handshake_), error));
    if (error && error != asio::error::would_block) return close();
    if (!handshake_.empty()) return wait(Socket::wait_write);
    close_after(most_silence);
    send_status(server_.site.status());
}

void Client::read() {
    std::array<std::uint8_t, 4096> bytes;
    Error error;
    const std::size_t count = socket_.read_some(asio::buffer(bytes), error);
    if (error == asio::error::would_block) return wait(Socket::wait_read);
    if (error) return close();
    if (wslay_event_want_read(stream_.get()) == 0)
        return wait(Socket::wait_read);  // closing: waits for the end of the stream
    bytes_ = std::span(bytes).first(count);
    wslay_event_recv(stream_.get());  // queues a close frame if the bytes break the protocol
    close_after(wslay_event_want_read(stream_.get()) != 0 ? most_silence : most_closing);
    is_pinged_ = false;
    send_what_is_ready();
}

void Client::take(bool is_text, const std::string& message) {
    std::optional<Question> question;
    if (is_text) question = server_.site.understand(message);
    if (!question) return send_status(R"({"error":"not understood"})");
    std::pair key(question->kind, question->slot);
    questions_.insert_or_assign(std::move(key), std::move(*question));
    send_what_is_ready();
}

void Client::tick(const std::string& status) {
    Peer::tick(status);
    const bool is_silent = handshake_.empty() && time_left() < most_silence / 2;
    if (is_silent && !is_pinged_ && wslay_event_want_read(stream_.get()) != 0) {
        is_pinged_ = true;
        queue(WSLAY_PING, "");
    }
    if (status.empty()) {
        send_what_is_ready();
    } else {
        send_status(status);
    }
}

void Client::send_status(const std::string& text) {
    status_ = text;
    has_new_status_ = true;
    send_what_is_ready();
}

void Client::send_what_is_ready() {
    if (!handshake_.empty() || !is_open_) return;
    const wslay_event_context_ptr stream = stream_.get();
    do {
        if (wslay_event_send(stream) != 0) return close();
    } while (queue_next());
    const bool is_closing = wslay_event_want_read(stream) == 0;
    if (wslay_event_want_write(stream) != 0) {
        wait(Socket::wait_write);
    } else if (is_closing) {
        is_open_ = false;
        Error ignored;
        socket_.shutdown(Socket::shutdown_send, ignored);
    }
    // Beside a message and a ping one answer to a ping is queued: further pings of a peer that reads nothing stay in the socket.
    if (is_closing ? !is_open_ : wslay_event_get_queued_msg_count(stream) < 3) wait(Socket::wait_read);
}

// Queues the newest status or an answer. Returns false if there is none or if a message is under way.
bool Client::queue_next() {
    if (wslay_event_want_read(stream_.get()) == 0 || wslay_event_get_queued_msg_count(stream_.get()) > 0) return false;
    if (has_new_status_) {
        has_new_status_ = false;
        queue(WSLAY_TEXT_FRAME, status_);
        return true;
    }
    for (auto asked = questions_.begin(); asked != questions_.end(); ++asked) {
        const std::optional<Answer> answer = server_.site.answer(asked->second);
        if (!answer) continue;
        questions_.erase(asked);
        queue(answer->is_binary ? WSLAY_BINARY_FRAME : WSLAY_TEXT_FRAME, *answer->bytes);
        return true;
    }
    return false;
}

// Makes one frame of a message, so that clients need not join frames.
void Client::queue(wslay_opcode kind, const std::string& bytes) {
    const wslay_event_msg message{static_cast<std::uint8_t>(kind), reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                  bytes.size()};
    if (wslay_event_queue_msg(stream_.get(), &message) != 0) throw std::bad_alloc();
}

void Server::accept() {
    acceptor.async_wait(Acceptor::wait_read, [this](Error error) {
        if (error) return;
        Socket socket = acceptor.accept(error);
        if (!error) socket.non_blocking(true, error);
        // Closes a connection without a request to make room for new ones.
        if (!error && connections.size() >= 4 * most_clients)
            (*std::min_element(connections.begin(), connections.end(), [](const auto& a, const auto& b) {
                return a->time_left() < b->time_left();
            }))->close();
        if (!error) std::make_shared<Connection>(std::move(socket), *this)->start(Socket::wait_read);
        accept();
    });
}

// Returns false if the site ends the server.
bool Server::tick() {
    if (!site.work()) return false;
    const bool tells = ++ticks % 32 == 0 && !clients.empty();
    const std::string status = tells ? site.status() : "";
    for (const Peers* peers : {&connections, &clients})
        for (const auto& peer : Peers(*peers)) peer->tick(status);
    return true;
}

}  // namespace

void serve(std::uint16_t port, const Pages& site, const std::function<void(const std::string& address)>& opened) {
    Server server(port, site);
    opened("http://127.0.0.1:" + std::to_string(server.port) + "/?key=" + server.key);
    server.accept();
    do {
        server.context.run_for(std::chrono::milliseconds(15));
    } while (server.tick());
}

}  // namespace wade::view
