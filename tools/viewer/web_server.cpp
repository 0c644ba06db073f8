#include "tools/viewer/web_server.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "configs/errors/exit_code.hpp"

namespace wade::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Error = boost::system::error_code;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

constexpr std::size_t most_clients = 24;
constexpr std::size_t most_question_bytes = 4096;
constexpr auto patience = std::chrono::seconds(15);

// Pages of other sites, and names that lead here by a trick of DNS, get nothing.
bool is_from_here(const Request& request, std::uint16_t port) {
    const std::string number = ":" + std::to_string(port);
    const std::string host(request[http::field::host]), origin(request[http::field::origin]);
    const bool known = host == "127.0.0.1" + number || host == "localhost" + number;
    return known && (origin.empty() || origin == "http://" + host);
}

struct Server;

class Client : public std::enable_shared_from_this<Client> {
 public:
    Client(tcp::socket socket, Server& server) : socket_(std::move(socket)), server_(server) {}

    void start(Request request);
    void send_what_is_ready();
    void send_status(const std::string& text);

 private:
    void read();
    void send(bool is_binary, Message bytes);

    websocket::stream<beast::tcp_stream> socket_;
    Server& server_;
    beast::flat_buffer buffer_;
    std::map<std::string, Question> questions_;
    bool is_open_ = false, is_sending_ = false, has_new_status_ = false;
    std::string status_;
};

struct Server {
    Server(std::uint16_t wanted, const Site& pages) : acceptor(context), timer(context), site(pages) {
        const tcp::endpoint place(asio::ip::address_v4::loopback(), wanted);
        Error error;
        acceptor.open(place.protocol(), error);
        acceptor.set_option(asio::socket_base::reuse_address(true), error);
        acceptor.bind(place, error);
        if (!error) acceptor.listen(64, error);
        if (error)
            throw ConfigurationError("--port " + std::to_string(wanted) + ": " + error.message() +
                                     "; allowed: a port that nobody has, 0 takes one.");
        port = acceptor.local_endpoint().port();
    }

    void accept();
    void tick();

    asio::io_context context{1};
    tcp::acceptor acceptor;
    asio::steady_timer timer;
    const Site& site;
    std::uint16_t port = 0;
    std::set<std::shared_ptr<Client>> clients;
    std::size_t connections = 0;
    unsigned ticks = 0;
};

// A request of HTTP and its answer; a connection that asks for the stream becomes a client.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
    Connection(tcp::socket socket, Server& server) : stream_(std::move(socket)), server_(server) {
        ++server_.connections;
    }
    ~Connection() { --server_.connections; }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    void read() {
        parser_.emplace();
        parser_->header_limit(8192);
        parser_->body_limit(0);
        stream_.expires_after(patience);
        http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
            if (error) return;  // closed, too slow, too long, or no HTTP
            self->answer(self->parser_->release());
        });
    }

 private:
    void answer(Request request) {
        if (!is_from_here(request, server_.port)) return send(request, http::status::forbidden, {"text/plain", "no\n"});
        if (websocket::is_upgrade(request)) {
            if (request.target() != "/stream") return send(request, http::status::not_found, {"text/plain", "no\n"});
            if (server_.clients.size() >= most_clients)
                return send(request, http::status::service_unavailable, {"text/plain", "too many pages are open\n"});
            return std::make_shared<Client>(stream_.release_socket(), server_)->start(std::move(request));
        }
        if (request.method() != http::verb::get && request.method() != http::verb::head)
            return send(request, http::status::method_not_allowed, {"text/plain", "only GET\n"});
        const std::string target(request.target());
        std::optional<WebFile> file = server_.site.file(target.substr(0, target.find('?')));
        if (!file) return send(request, http::status::not_found, {"text/plain", "there is no such file\n"});
        send(request, http::status::ok, std::move(*file));
    }

    void send(const Request& request, http::status status, WebFile file) {
        response_ = Response(status, request.version());
        response_.set(http::field::content_type, file.type);
        response_.set(http::field::cache_control, "no-cache");
        response_.set("X-Content-Type-Options", "nosniff");
        response_.set("Content-Security-Policy",
                      "default-src 'self'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
                      "img-src 'self' data: blob:");
        response_.keep_alive(request.keep_alive());
        response_.body() = std::move(file.body);
        response_.prepare_payload();
        if (request.method() == http::verb::head) response_.body().clear();
        stream_.expires_after(patience);
        http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t) {
            if (!error && self->response_.keep_alive()) self->read();
        });
    }

    beast::tcp_stream stream_;
    Server& server_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::empty_body>> parser_;
    Response response_;
};

void Client::start(Request request) {
    websocket::stream_base::timeout times = websocket::stream_base::timeout::suggested(beast::role_type::server);
    times.idle_timeout = std::chrono::seconds(60);
    socket_.set_option(times);
    socket_.read_message_max(most_question_bytes);
    socket_.auto_fragment(false);  // a message is one frame, which simple clients read
    server_.clients.insert(shared_from_this());
    const auto kept = std::make_shared<Request>(std::move(request));
    socket_.async_accept(*kept, [self = shared_from_this(), kept](Error error) {
        if (error) {
            self->server_.clients.erase(self);
            return;
        }
        self->is_open_ = true;
        self->send_status(self->server_.site.status());
        self->read();
    });
}

void Client::read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
        if (error) {
            self->is_open_ = false;
            self->server_.clients.erase(self);
            return;
        }
        const std::string text = beast::buffers_to_string(self->buffer_.data());
        self->buffer_.consume(self->buffer_.size());
        std::optional<Question> question;
        if (self->socket_.got_text()) question = self->server_.site.understand(text);
        if (question) {
            const std::string kind = question->kind;
            self->questions_[kind] = std::move(*question);
        } else {
            self->send_status(R"({"error":"not understood"})");
        }
        self->send_what_is_ready();
        self->read();
    });
}

void Client::send_status(const std::string& text) {
    status_ = text;
    has_new_status_ = true;
    send_what_is_ready();
}

void Client::send_what_is_ready() {
    if (!is_open_ || is_sending_) return;
    if (has_new_status_) {
        has_new_status_ = false;
        return send(false, std::make_shared<std::string>(status_));
    }
    for (auto asked = questions_.begin(); asked != questions_.end(); ++asked) {
        const std::optional<Answer> answer = server_.site.answer(asked->second);
        if (!answer) continue;
        questions_.erase(asked);
        return send(answer->is_binary, answer->bytes);
    }
}

void Client::send(bool is_binary, Message bytes) {
    is_sending_ = true;
    socket_.binary(is_binary);
    const asio::const_buffer view(bytes->data(), bytes->size());
    socket_.async_write(view, [self = shared_from_this(), bytes](Error error, std::size_t) {
        self->is_sending_ = false;
        if (!error) self->send_what_is_ready();  // else the read fails, too
    });
}

void Server::accept() {
    acceptor.async_accept([this](Error error, tcp::socket socket) {
        if (!error && connections < 4 * most_clients) std::make_shared<Connection>(std::move(socket), *this)->read();
        if (acceptor.is_open()) accept();
    });
}

void Server::tick() {
    timer.expires_after(std::chrono::milliseconds(15));
    timer.async_wait([this](Error error) {
        if (error) return;
        if (!site.work()) return context.stop();
        const bool tells = ++ticks % 32 == 0 && !clients.empty();
        const std::string text = tells ? site.status() : "";
        for (const auto& client : std::set(clients)) {
            if (tells) {
                client->send_status(text);
            } else {
                client->send_what_is_ready();
            }
        }
        tick();
    });
}

}  // namespace

void serve(std::uint16_t port, const Site& site, const std::function<void(std::uint16_t)>& opened) {
    Server server(port, site);
    opened(server.port);
    server.accept();
    server.tick();
    server.context.run();
}

}  // namespace wade::view
