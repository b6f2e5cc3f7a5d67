// Requests: who may make them, and what becomes of those that are none.

#include "served.hpp"

namespace knurl::gateway {

namespace {

using namespace std::chrono_literals;

TEST(GatewayLogin, PageNeedsSession) {
    Served served;
    const Answer without = served.ask(served.request("GET /"));
    EXPECT_EQ(without.status, 403);
    EXPECT_NE(without.body.find("?token="), std::string::npos) << without.body;
    EXPECT_EQ(std::count(without.body.begin(), without.body.end(), '\n'), 1);

    const Answer with = served.ask(served.request("GET /", served.cookie()));
    EXPECT_EQ(with.status, 200);
    EXPECT_EQ(with.body, "page");
}

TEST(GatewayLogin, TokenWorksOnce) {
    Served served;
    const Answer first = served.ask(served.request("GET /?token=" + served.token));
    EXPECT_EQ(first.status, 303);
    EXPECT_EQ(first.header("Location"), "/");
    const std::string cookie = first.header("Set-Cookie");
    for (const char* part : {"; HttpOnly", "; SameSite=Strict", "; Path=/"})
        EXPECT_NE(cookie.find(part), std::string::npos) << cookie;
    EXPECT_EQ(cookie.find('='), cookie.find(';') - 33) << "128 bits: " << cookie;

    const Answer again = served.ask(served.request("GET /?token=" + served.token));
    EXPECT_EQ(again.status, 403);
    EXPECT_NE(again.body.find("SIGUSR1"), std::string::npos) << again.body;
}

TEST(GatewayLogin, LookingAheadUsesNoToken) {
    Served served;
    EXPECT_EQ(served.ask(served.request("HEAD /?token=" + served.token)).status, 403);
    EXPECT_EQ(served.ask(served.request("GET /?token=" + served.token)).status, 303);
}

TEST(GatewayLogin, WhoHasASessionMayOpenTheOldAddressAgain) {
    Served served;
    const std::string cookie = served.cookie();
    const Answer again = served.ask(served.request("GET /?token=used", cookie));
    EXPECT_EQ(again.status, 303);
    EXPECT_EQ(again.header("Set-Cookie"), "");
}

TEST(GatewayLogin, TokenThatIsNoneOrOldOpensNothing) {
    Served served;
    std::string wrong = served.token;
    wrong.back() = wrong.back() == '0' ? '1' : '0';
    for (const std::string& each : {wrong, std::string(), served.token.substr(1), served.token + "0"})
        EXPECT_EQ(served.ask(served.request("GET /?token=" + each)).status, 403) << each;
    served.in_server([&] { served.server().new_token(); });
    EXPECT_EQ(served.ask(served.request("GET /?token=" + served.token)).status, 403) << "it was replaced";
}

TEST(GatewayLogin, CookieThatIsNoneOpensNothing) {
    Served served;
    const std::string good = served.cookie();
    std::string wrong = good;
    char& digit = wrong[wrong.size() - 3];
    digit = digit == '0' ? '1' : '0';
    EXPECT_EQ(served.ask(served.request("GET /", wrong)).status, 403);
    EXPECT_EQ(served.ask(served.request("GET /", "Cookie: a=b; c\r\n")).status, 403);
    EXPECT_EQ(served.ask(served.request("GET /", "Cookie: a=b; " + good.substr(8))).status, 200);
}

TEST(GatewayLogin, SessionsAreBounded) {
    Served served({.most_sessions = 2});
    const std::string first = served.cookie(), second = served.cookie();
    EXPECT_EQ(served.ask(served.request("GET /", first)).status, 200);  // now the second was idle longest
    const std::string third = served.cookie();
    EXPECT_EQ(served.ask(served.request("GET /", second)).status, 403);
    EXPECT_EQ(served.ask(served.request("GET /", first)).status, 200);
    EXPECT_EQ(served.ask(served.request("GET /", third)).status, 200);
}

TEST(GatewayHttp, EveryAnswerProtectsThePage) {
    Served served;
    for (const std::string& each :
         {served.request("GET /"), served.request("GET /", served.cookie()), std::string("x\r\n\r\n")}) {
        const Answer answer = served.ask(each);
        EXPECT_NE(answer.header("Content-Security-Policy").find("default-src 'none'; script-src 'self'"),
                  std::string::npos)
            << answer.head;
        EXPECT_NE(answer.header("Content-Security-Policy").find("frame-ancestors 'none'"), std::string::npos);
        EXPECT_EQ(answer.header("X-Content-Type-Options"), "nosniff");
        EXPECT_EQ(answer.header("Referrer-Policy"), "no-referrer");
        EXPECT_EQ(answer.header("Cache-Control"), "no-store");
    }
}

TEST(GatewayHttp, HostOfAnotherNameIsRefused) {
    Served served;
    const std::string cookie = served.cookie(), port = std::to_string(served.port);
    for (const std::string& good :
         {"127.0.0.1:" + port, "localhost:" + port, "LocalHost:" + port, "[::1]:" + port})
        EXPECT_EQ(served.ask("GET / HTTP/1.1\r\nHost: " + good + "\r\n" + cookie + "\r\n").status, 200)
            << good;
    for (const std::string& bad :
         {std::string("evil.example"), "evil.example:" + port, std::string("127.0.0.1"),
          std::string("127.0.0.1:1"), "127.0.0.1:" + port + ".evil.example", std::string()})
        EXPECT_EQ(served.ask("GET / HTTP/1.1\r\nHost: " + bad + "\r\n" + cookie + "\r\n").status, 403) << bad;
    EXPECT_EQ(served.ask("GET / HTTP/1.1\r\n" + cookie + "\r\n").status, 400);
    EXPECT_EQ(served.ask(served.request("GET /", "Host: evil.example\r\n" + cookie)).status, 400) << "two";
    // Once for this host, however often.
    EXPECT_EQ(served.said("Host 'evil.example'"), 1);
}

TEST(GatewayHttp, FurtherNamesOfTheHost) {
    Served served({}, [](Site& site) { site.hosts = {"lab.example", "localhost:9000"}; });
    const std::string cookie = served.cookie(), port = std::to_string(served.port);
    EXPECT_EQ(served.ask("GET / HTTP/1.1\r\nHost: lab.example:" + port + "\r\n" + cookie + "\r\n").status,
              200);
    EXPECT_EQ(served.ask("GET / HTTP/1.1\r\nHost: localhost:9000\r\n" + cookie + "\r\n").status, 200);
    EXPECT_EQ(served.ask("GET / HTTP/1.1\r\nHost: lab.example:1\r\n" + cookie + "\r\n").status, 403);
}

TEST(GatewayHttp, PostOfAnotherOriginIsRefused) {
    Served served;
    const std::string cookie = served.cookie();
    EXPECT_EQ(served.ask(served.request("POST /echo", cookie, "a")).status, 200) << "none: no page";
    EXPECT_EQ(
        served.ask(served.request("POST /echo", cookie + "Origin: " + served.origin() + "\r\n", "a")).status,
        200);
    EXPECT_EQ(served.answered, 2);
    for (const std::string& bad :
         {std::string("http://evil.example"), std::string("null"), std::string(),
          "https" + served.origin().substr(4), served.origin() + "0", std::string("https://app.example")})
        EXPECT_EQ(served.ask(served.request("POST /echo", cookie + "Origin: " + bad + "\r\n", "a")).status,
                  403)
            << bad;
    EXPECT_EQ(served
                  .ask(served.request(
                      "POST /echo",
                      cookie + "Origin: " + served.origin() + "\r\nOrigin: http://evil.example\r\n", "a"))
                  .status,
              403);
    EXPECT_EQ(served.answered, 2);
    EXPECT_EQ(served.said("Origin 'http://evil.example'"), 1);
}

TEST(GatewayHttp, RoleIsAsked) {
    Served served({}, [](Site& site) {
        for (HttpRoute& route : site.http) route.access.without_key = Role::observe;
    });
    EXPECT_EQ(served.ask(served.request("GET /")).status, 200);
    const Answer answer = served.ask(served.request("POST /large", {}, "mesh"));
    EXPECT_EQ(answer.status, 403);
    EXPECT_EQ(answer.body, "your role is observe; this needs render\n");
    EXPECT_EQ(served.ask(served.request("POST /large", served.cookie(), "mesh")).body, "mesh");
}

TEST(GatewayHttp, Routes) {
    Served served;
    const std::string cookie = served.cookie();
    EXPECT_EQ(served.ask(served.request("GET /asset/0/%41", cookie)).body, "asset /asset/0/A");
    EXPECT_EQ(served.ask(served.request("GET /asset/special1", cookie)).body, "special");
    EXPECT_EQ(served.ask(served.request("GET /asset", cookie)).status, 404);
    EXPECT_EQ(served.ask(served.request("GET /nothing", cookie)).status, 404);
    EXPECT_EQ(served.ask(served.request("POST /app.js", cookie, "a")).status, 405);
    EXPECT_EQ(served.ask(served.request("DELETE /", cookie)).status, 405);
    for (const char* bad :
         {"GET x", "GET http://127.0.0.1/", "GET /%", "GET /%0a", "GET /%zz", "GET /?a=%00"})
        EXPECT_EQ(served.ask(served.request(bad, cookie)).status, 400) << bad;
}

TEST(GatewayHttp, Files) {
    Served served;
    const std::string cookie = served.cookie();
    const Answer plain = served.ask(served.request("GET /app.js", cookie));
    EXPECT_EQ(plain.body, "plain");
    EXPECT_EQ(plain.header("Content-Type"), "text/javascript");
    EXPECT_EQ(plain.header("ETag"), "\"abc\"");
    EXPECT_EQ(plain.header("Content-Encoding"), "");
    const Answer packed =
        served.ask(served.request("GET /app.js", cookie + "Accept-Encoding: br, gzip;q=1.0\r\n"));
    EXPECT_EQ(packed.body, "packed");
    EXPECT_EQ(packed.header("Content-Encoding"), "gzip");
    const Answer known = served.ask(served.request("GET /app.js", cookie + "If-None-Match: \"abc\"\r\n"));
    EXPECT_EQ(known.status, 304);
    EXPECT_EQ(known.body, "");

    Caller caller(served.port);
    caller.send(served.request("HEAD /app.js", cookie) + served.request("GET /", cookie));
    EXPECT_EQ(read_answer(caller, false).header("Content-Length"), "5");
    EXPECT_EQ(read_answer(caller).body, "page") << "nothing was between";
}

TEST(GatewayHttp, ByteByByte) {
    Served served;
    Caller caller(served.port);
    for (const char c : served.request("POST /echo", served.cookie(), "body")) caller.send({&c, 1});
    EXPECT_EQ(read_answer(caller).body, "body");
}

TEST(GatewayHttp, ManyAtOnce) {
    Served served;
    const std::string cookie = served.cookie();
    Caller caller(served.port);
    std::string all;
    for (int i = 0; i < 50; ++i) all += served.request("POST /echo", cookie, std::to_string(i));
    caller.send(all);
    for (int i = 0; i < 50; ++i) EXPECT_EQ(read_answer(caller).body, std::to_string(i));
}

TEST(GatewayHttp, ChunkedBody) {
    Served served;
    const std::string cookie = served.cookie();
    const auto ask = [&](const std::string& chunks) {
        return served.ask(served.request("POST /echo", cookie + "Transfer-Encoding: chunked\r\n") + chunks);
    };
    EXPECT_EQ(ask("3\r\nabc\r\n2\r\nde\r\n0\r\n\r\n").body, "abcde");
    std::string too_much;
    for (int i = 0; i < 5; ++i) too_much += "4000\r\n" + std::string(0x4000, 'x') + "\r\n";
    EXPECT_EQ(ask(too_much + "0\r\n\r\n").status, 413);
    EXPECT_EQ(ask("nonsense\r\n").status, 400);
}

TEST(GatewayHttp, TooLong) {
    Served served;
    const std::string cookie = served.cookie();
    EXPECT_EQ(served.ask(served.request("GET /", "X: " + std::string(20000, 'x') + "\r\n" + cookie)).status,
              431);
    EXPECT_EQ(served.ask("GET /" + std::string(200000, 'x')).status, 431);
    EXPECT_EQ(served.ask(served.request("POST /echo", cookie, std::string(65536, 'x'))).status, 200);
    EXPECT_EQ(served.ask(served.request("POST /echo", cookie, std::string(65537, 'x'))).status, 413);
    EXPECT_EQ(served.ask(served.request("POST /large", cookie, std::string(1 << 20, 'x'))).body.size(),
              1U << 20);
    // Refused by what it says; the answer is not lost in what is sent nevertheless.
    EXPECT_EQ(served.ask(served.request("POST /large", cookie, std::string((1 << 20) + 1, 'x'))).status, 413);
    EXPECT_EQ(
        served.ask(served.request("POST /large", cookie + "Content-Length: 99999999999999999999\r\n")).status,
        400);
    EXPECT_EQ(
        served.ask(served.request("POST /large", cookie + "Content-Length: 9223372036854775807\r\n")).status,
        413);
    EXPECT_EQ(served.ask(served.request("GET /", cookie)).status, 200);
}

TEST(GatewayHttp, RefusedInTheMiddleOfABodyIsNotCutOff) {
    Served served;
    Caller caller(served.port);
    caller.send(served.request("POST /large", served.cookie() + "Content-Length: 2000000\r\n") +
                std::string(300000, 'x'));
    EXPECT_EQ(read_answer(caller).status, 413);
    EXPECT_TRUE(caller.send(std::string(300000, 'x')));
    EXPECT_TRUE(caller.ends_well());
}

TEST(GatewayHttp, BodiesThatAreReadAreBoundedTogether) {
    Served served({.most_bodies = 3 << 19});
    const std::string cookie = served.cookie();
    const std::string announced = cookie + "Content-Length: 1048576\r\nExpect: 100-continue\r\n";
    {
        Caller first(served.port);
        first.send(served.request("POST /large", announced));
        EXPECT_EQ(read_answer(first).status, 100) << "it has a megabyte of them";
        EXPECT_EQ(served.ask(served.request("POST /large", announced)).status, 503);
        first.send(std::string(1 << 20, 'x'));
        EXPECT_EQ(read_answer(first).body.size(), 1U << 20);
    }
    EXPECT_EQ(served.ask(served.request("POST /large", announced)).status, 100);
}

TEST(GatewayHttp, WhatIsNoHttp) {
    Served served;
    for (const std::string& each :
         {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
          std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET  HTTP/1.1\r\n\r\n"),
          std::string("\0\0\0\0\r\n\r\n", 8), std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
          served.request("GET /", "A B: c\r\n"), served.request("GET /", "A: b\x01\r\n"),
          served.request("POST /echo", "Content-Length: 1\r\nContent-Length: 2\r\n", "")})
        EXPECT_EQ(served.ask(each).status, 400) << each;
    EXPECT_EQ(served.ask("GET / HTTP/1.0\r\nHost: " + served.host() + "\r\n\r\n").status, 505);
}

TEST(GatewayHttp, HalfARequestEnds) {
    Served served({.request_time = 30ms, .idle_time = 60s, .closing_time = 30ms});
    const std::string cookie = served.cookie();
    Caller nothing(served.port), half(served.port), half_body(served.port);
    half.send("GET / HT");
    half_body.send(served.request("POST /echo", cookie + "Content-Length: 10\r\n") + "half");
    for (Caller* each : {&nothing, &half, &half_body}) EXPECT_TRUE(each->at_end());
    EXPECT_EQ(served.ask(served.request("GET /", cookie)).status, 200);
}

TEST(GatewayHttp, IdleConnectionEnds) {
    Served served({.idle_time = 30ms});
    Caller caller(served.port);
    caller.send(served.request("GET /", served.cookie()));
    EXPECT_EQ(read_answer(caller).status, 200);
    EXPECT_TRUE(caller.at_end());
}

TEST(GatewayHttp, AnswerThatThrows) {
    Served served;
    const std::string cookie = served.cookie();
    const Answer answer = served.ask(served.request("GET /throw", cookie));
    EXPECT_EQ(answer.status, 500);
    EXPECT_EQ(answer.body, "internal error\n") << "says nothing of the inside";
    EXPECT_EQ(served.said("/throw failed: asked to"), 1);
    EXPECT_EQ(served.ask(served.request("GET /", cookie)).status, 200);
}

TEST(GatewayHttp, CallerWhoHangsUp) {
    Served served;
    const std::string cookie = served.cookie();
    const std::string whole = served.request("POST /echo", cookie, std::string(1000, 'x'));
    for (std::size_t cut = 0; cut < whole.size(); cut += 97) {
        Caller caller(served.port);
        caller.send(std::string_view(whole).substr(0, cut));
    }
    EXPECT_EQ(served.ask(served.request("GET /", cookie)).status, 200);
}

}  // namespace

}  // namespace knurl::gateway
