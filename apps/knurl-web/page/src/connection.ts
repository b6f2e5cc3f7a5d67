// The socket: messages in, requests out, and again after it was lost.
import { type Answer, type Message, type Reports, decodeBinary } from "./protocol.ts";

export interface Handlers {
  message(message: Message): void;
  reports(reports: Reports): void;
  /** `why`: "" when connected. `retry`: seconds until the next attempt; 0: there is none, or it runs. */
  link(state: "open" | "lost" | "gone", why: string, retry: number): void;
  /** A message that is none of ours. */
  strange(text: string): void;
}

const longestWait = 8; // s
const patience = 10; // s, until a request is given up

export class Connection {
  private socket: WebSocket | null = null;
  private pending = new Map<number, { resolve: (answer: Answer) => void; reject: (error: Error) => void; timer: number }>();
  private next = 1;
  private attempts = 0;
  private timer = 0;
  private stopped = false;
  reconnects = 0;
  messages = 0;
  /** ms of own work for messages since they were taken. */
  work = 0;
  private opened = false;

  constructor(
    private readonly url: string,
    private readonly handlers: Handlers,
  ) {}

  open(): void {
    window.clearTimeout(this.timer);
    const socket = new WebSocket(this.url, "knurl.live.v1");
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      if (this.opened) this.reconnects++;
      this.opened = true;
      this.attempts = 0;
      this.handlers.link("open", "", 0);
    };
    socket.onmessage = (event) => {
      const begin = performance.now();
      this.messages++;
      try {
        if (typeof event.data === "string") this.text(event.data);
        else this.handlers.reports(decodeBinary(event.data as ArrayBuffer));
      } catch (error) {
        this.handlers.strange(error instanceof Error ? error.message : String(error));
      }
      this.work += performance.now() - begin;
    };
    socket.onclose = (event) => {
      if (this.socket !== socket) return;
      this.socket = null;
      for (const [, waiting] of this.pending) {
        window.clearTimeout(waiting.timer);
        waiting.reject(new Error("the connection was lost before the answer came"));
      }
      this.pending.clear();
      if (!this.stopped) void this.lost(event.reason);
    };
  }

  private text(data: string): void {
    let message: Message;
    try {
      message = JSON.parse(data) as Message;
    } catch {
      throw new Error(`a message that is no JSON: ${data.slice(0, 60)}`);
    }
    if (message === null || typeof message !== "object" || typeof message.op !== "string")
      throw new Error(`a message without op: ${data.slice(0, 60)}`);
    if (message.op === "answer") {
      const waiting = this.pending.get(message.id);
      if (!waiting) return;
      this.pending.delete(message.id);
      window.clearTimeout(waiting.timer);
      if (message.ok) waiting.resolve(message);
      else waiting.reject(new Error(message.error ?? "refused without a reason"));
      return;
    }
    this.handlers.message(message);
  }

  /** A refused session cannot be told from a server that is away by the socket alone, so the page is asked for. */
  private async lost(reason: string): Promise<void> {
    this.attempts++;
    const wait = Math.min(longestWait, 0.5 * 2 ** (this.attempts - 1));
    this.handlers.link("lost", reason || "the connection to knurl-web was lost", wait);
    try {
      const answer = await fetch("./", { cache: "no-store" });
      if (answer.status === 401 || answer.status === 403) {
        this.handlers.link("gone", "knurl-web no longer knows this page (it was started anew, or its token changed)", 0);
        return;
      }
    } catch {
      // away
    }
    this.timer = window.setTimeout(() => this.open(), wait * 1000);
  }

  get connected(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** Rejects with one line where it is refused. */
  request(op: string, body: Record<string, unknown> = {}): Promise<Answer> {
    const socket = this.socket;
    if (!socket || socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error("not connected to knurl-web"));
    const id = this.next++;
    return new Promise((resolve, reject) => {
      const timer = window.setTimeout(
        () => {
          this.pending.delete(id);
          reject(new Error(`${op}: no answer within ${op === "doctor" ? 120 : patience} s`));
        },
        (op === "doctor" ? 120 : patience) * 1000,
      );
      this.pending.set(id, { resolve, reject, timer });
      socket.send(JSON.stringify({ op, id, ...body }));
    });
  }

  /** For pages that end. */
  close(): void {
    this.stopped = true;
    this.socket?.close();
  }
}
