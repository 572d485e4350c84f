/** What is wrong with a formula, and at which of its characters. */
export class FormulaError extends Error {
  constructor(
    message: string,
    readonly at: number,
  ) {
    super(message);
  }
}

export type Expression = { at: number } & (
  | { kind: "number"; value: number }
  | { kind: "name"; name: string }
  | { kind: "call"; name: string; args: Expression[] }
  | { kind: "unary"; operator: "-" | "!"; of: Expression }
  | { kind: "binary"; operator: string; left: Expression; right: Expression }
  | { kind: "choice"; test: Expression; yes: Expression; no: Expression }
);

/** Longer ones, or with more parts or deeper, are not drawn sixty times a second. */
export const LENGTH_MAX = 300;
const PARTS_MAX = 64;
const DEPTH_MAX = 24;

/** From the loosest to the tightest; `^` and the choice are read from the right, and a sign is looser than `^`. */
const LEVELS: readonly (readonly string[])[] = [["||"], ["&&"], ["==", "<", ">"], ["+", "-"], ["*", "/", "%"]];

const TOKEN =
  /\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)|(\|\||&&|==|[-+*/%^<>!?:(),]))/y;

interface Token {
  text: string;
  kind: "number" | "name" | "sign" | "end";
  at: number;
}

function tokens(formula: string): Token[] {
  const found: Token[] = [];
  TOKEN.lastIndex = 0;
  let at = 0;
  while (formula.slice(at).trim() !== "") {
    TOKEN.lastIndex = at;
    const match = TOKEN.exec(formula);
    if (!match) {
      const place = at + formula.slice(at).search(/\S/);
      throw new FormulaError(`“${formula[place]}” is no part of a formula`, place);
    }
    const [all, number, name, sign] = match;
    const text = number ?? name ?? sign ?? "";
    found.push({ text, kind: number ? "number" : name ? "name" : "sign", at: at + all.length - text.length });
    at += all.length;
  }
  return [...found, { text: "", kind: "end", at: formula.length }];
}

/** The tree of a formula: numbers, names, calls, `+ - * / % ^ < > == && || !` and `?:`. Nothing else is one. */
export function parse(formula: string): Expression {
  if (formula.length > LENGTH_MAX)
    throw new FormulaError(
      `a formula has ${LENGTH_MAX} characters at the most, this has ${formula.length}`,
      LENGTH_MAX,
    );
  return new Parser(tokens(formula)).whole();
}

class Parser {
  private place = 0;
  private parts = 0;
  private depth = 0;

  constructor(private readonly list: readonly Token[]) {}

  whole(): Expression {
    const found = this.choice();
    if (this.token.kind !== "end") throw this.wrong();
    return found;
  }

  private get token(): Token {
    return this.list[this.place] as Token;
  }

  private wrong(): FormulaError {
    const { kind, text, at } = this.token;
    return new FormulaError(kind === "end" ? "the formula ends too early" : `“${text}” does not fit here`, at);
  }

  private next(text: string): boolean {
    if (this.token.kind !== "sign" || this.token.text !== text) return false;
    this.place += 1;
    return true;
  }

  private need(text: string): void {
    if (!this.next(text)) throw this.wrong();
  }

  private made(expression: Expression): Expression {
    this.parts += 1;
    if (this.parts > PARTS_MAX) throw new FormulaError(`a formula has ${PARTS_MAX} parts at the most`, expression.at);
    return expression;
  }

  private choice(): Expression {
    this.depth += 1;
    if (this.depth > DEPTH_MAX) throw new FormulaError(`a formula is ${DEPTH_MAX} deep at the most`, this.token.at);
    const test = this.level(0);
    const { at } = this.token;
    let found = test;
    if (this.next("?")) {
      const yes = this.choice();
      this.need(":");
      found = this.made({ kind: "choice", at, test, yes, no: this.choice() });
    }
    this.depth -= 1;
    return found;
  }

  private level(index: number): Expression {
    const operators = LEVELS[index];
    if (!operators) return this.sign();
    let left = this.level(index + 1);
    for (;;) {
      const { text, kind, at } = this.token;
      if (kind !== "sign" || !operators.includes(text)) return left;
      this.place += 1;
      left = this.made({ kind: "binary", operator: text, at, left, right: this.level(index + 1) });
    }
  }

  private sign(): Expression {
    const { text, at } = this.token;
    if (this.token.kind === "sign" && (text === "-" || text === "!")) {
      this.place += 1;
      this.depth += 1;
      if (this.depth > DEPTH_MAX) throw new FormulaError(`a formula is ${DEPTH_MAX} deep at the most`, at);
      const of = this.sign();
      this.depth -= 1;
      return this.made({ kind: "unary", operator: text, at, of });
    }
    const base = this.primary();
    const { at: power } = this.token;
    return this.next("^")
      ? this.made({ kind: "binary", operator: "^", at: power, left: base, right: this.sign() })
      : base;
  }

  private primary(): Expression {
    const { text, kind, at } = this.token;
    if (kind === "number") {
      this.place += 1;
      return this.made({ kind: "number", value: Number(text), at });
    }
    if (kind === "name") {
      this.place += 1;
      if (!this.next("(")) return this.made({ kind: "name", name: text, at });
      const args: Expression[] = [];
      if (!this.next(")")) {
        do args.push(this.choice());
        while (this.next(","));
        this.need(")");
      }
      return this.made({ kind: "call", name: text, args, at });
    }
    if (!this.next("(")) throw this.wrong();
    const inside = this.choice();
    this.need(")");
    return inside;
  }
}
