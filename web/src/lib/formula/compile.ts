import { type Dimension, dimensionText, isNumber, NUMBER, PER_SECOND, raised, SECOND, same, times } from "./dimension";
import * as filters from "./filters";
import { type Expression, FormulaError, parse } from "./parse";

export { FormulaError } from "./parse";

/** Samples of all inputs at the same times. Rows before `from` are not shown: filters begin with them. */
export interface Rows {
  times: Float64Array;
  columns: Readonly<Record<string, Float64Array>>;
  from: number;
}

export interface Formula {
  dimension: Dimension;
  /** how much before what is shown its filters have to begin [s] */
  leadS: number;
  /** the inputs that it has, the leading one first */
  inputs: readonly string[];
  run: (rows: Rows) => Float64Array;
}

interface Part {
  /** null: a plain number as it is written, which takes the unit of what it is added to */
  dimension: Dimension | null;
  constant: number | null;
  leadS: number;
  run: (rows: Rows) => Float64Array;
}

/** A filter that looks further back would need more than the page keeps [s]. */
export const LOOK_BACK_MAX_S = 60;
const CONSTANTS: Readonly<Record<string, number>> = { pi: Math.PI, e: Math.E };

type Kind = "same" | "number";
interface Plain {
  args: number;
  /** what its arguments have to be: of one unit, or plain numbers */
  of: Kind;
  /** of which unit it is */
  gives: Kind;
  call: (...values: number[]) => number;
}

const PLAIN: Readonly<Record<string, Plain>> = {
  abs: { args: 1, of: "same", gives: "same", call: Math.abs },
  sign: { args: 1, of: "same", gives: "number", call: Math.sign },
  sin: { args: 1, of: "number", gives: "number", call: Math.sin },
  cos: { args: 1, of: "number", gives: "number", call: Math.cos },
  atan2: { args: 2, of: "same", gives: "number", call: Math.atan2 },
  min: { args: 2, of: "same", gives: "same", call: Math.min },
  max: { args: 2, of: "same", gives: "same", call: Math.max },
  clamp: {
    args: 3,
    of: "same",
    gives: "same",
    call: (x = 0, low = 0, high = 0) => (x < low ? low : x > high ? high : x),
  },
  hypot: { args: 2, of: "same", gives: "same", call: Math.hypot },
  wrap: {
    args: 2,
    of: "same",
    gives: "same",
    call: (x = 0, period = 0) => x - period * Math.floor(x / period + 0.5),
  },
};

/** Those with a memory: a constant beside the input, or none. */
interface Remembering {
  constant: "s" | "Hz" | "period" | null;
  gives?: Dimension;
  run: (times: Float64Array, x: Float64Array, constant: number, from: number) => Float64Array;
}

const REMEMBERING: Readonly<Record<string, Remembering>> = {
  d: { constant: null, gives: PER_SECOND, run: filters.derivative },
  int: { constant: null, gives: SECOND, run: (time, x, _, from) => filters.integral(time, x, from) },
  mean: { constant: "s", run: filters.mean },
  rms: { constant: "s", run: filters.rms },
  delay: { constant: "s", run: filters.delayed },
  lowpass: { constant: "Hz", run: filters.lowpass },
  unwrap: { constant: "period", run: (_, x, period) => filters.unwrapped(x, period) },
};

/** Names of functions with what they take, for the help beside the field. */
export const FUNCTIONS: readonly string[] = [
  ...Object.entries(PLAIN).map(([name, { args }]) => `${name}(${["x", "y", "z"].slice(0, args).join(", ")})`),
  "sqrt(x)",
  ...Object.entries(REMEMBERING).map(([name, { constant }]) => `${name}(x${constant ? `, ${constant}` : ""})`),
];

/**
 * A formula of inputs with these dimensions, ready to run. Throws a FormulaError that says what is wrong and where: what
 * is no formula, a name that nothing has, units that do not go together.
 */
export function compile(formula: string, inputs: Readonly<Record<string, Dimension>>): Formula {
  const used: string[] = [];
  const whole = new Compiler(inputs, used).part(parse(formula));
  const [leading] = used;
  if (leading === undefined) throw new FormulaError("it has no input: its samples would be at no time", 0);
  return {
    dimension: whole.dimension ?? NUMBER,
    leadS: whole.leadS,
    inputs: used,
    run: (rows) => whole.run(rows),
  };
}

class Compiler {
  constructor(
    private readonly inputs: Readonly<Record<string, Dimension>>,
    private readonly used: string[],
  ) {}

  part(expression: Expression): Part {
    switch (expression.kind) {
      case "number":
        return constant(expression.value);
      case "name":
        return this.named(expression.name, expression.at);
      case "call":
        return this.call(expression);
      case "unary": {
        const of = this.part(expression.of);
        if (expression.operator === "-") return mapped(of.dimension, [of], (x = 0) => -x);
        return mapped(NUMBER, [of], (x = 0) => truth(x, x === 0));
      }
      case "choice": {
        const [test, yes, no] = [this.part(expression.test), this.part(expression.yes), this.part(expression.no)];
        const dimension = common([yes, no], "what a choice is between", expression.at);
        return mapped(dimension, [test, yes, no], (x = 0, one = 0, other = 0) =>
          Number.isNaN(x) ? Number.NaN : x !== 0 ? one : other,
        );
      }
      case "binary":
        return this.binary(expression);
    }
  }

  private named(name: string, at: number): Part {
    const known = CONSTANTS[name];
    const dimension = Object.hasOwn(this.inputs, name) ? this.inputs[name] : undefined;
    if (dimension) {
      if (!this.used.includes(name)) this.used.push(name);
      return { dimension, constant: null, leadS: 0, run: ({ columns }) => columns[name] as Float64Array };
    }
    if (known !== undefined && Object.hasOwn(CONSTANTS, name)) return constant(known);
    const names = [...Object.keys(this.inputs), ...Object.keys(CONSTANTS)].join(", ");
    throw new FormulaError(`there is no input “${name}”; there are ${names}`, at);
  }

  private binary({ operator, left, right, at }: Extract<Expression, { kind: "binary" }>): Part {
    const [one, other] = [this.part(left), this.part(right)];
    const both = [one, other];
    switch (operator) {
      case "*":
        return mapped(product(one, other, 1), both, (x = 0, y = 0) => x * y);
      case "/":
        return mapped(product(one, other, -1), both, (x = 0, y = 0) => x / y);
      case "^": {
        if (other.constant === null) throw new FormulaError("what is behind ^ is a number", at);
        const by = other.constant;
        return mapped(one.dimension && raised(one.dimension, by), [one], (x = 0) => x ** by);
      }
      case "+":
        return mapped(common(both, "what is added", at), both, (x = 0, y = 0) => x + y);
      case "-":
        return mapped(common(both, "what is subtracted", at), both, (x = 0, y = 0) => x - y);
      case "%":
        return mapped(common(both, "what is divided with a rest", at), both, (x = 0, y = 0) => x % y);
      case "&&":
        return mapped(NUMBER, both, (x = 0, y = 0) => truth(x + y, x !== 0 && y !== 0));
      case "||":
        return mapped(NUMBER, both, (x = 0, y = 0) => truth(x + y, x !== 0 || y !== 0));
    }
    common(both, "what is compared", at);
    if (operator === "<") return mapped(NUMBER, both, (x = 0, y = 0) => truth(x + y, x < y));
    if (operator === ">") return mapped(NUMBER, both, (x = 0, y = 0) => truth(x + y, x > y));
    return mapped(NUMBER, both, (x = 0, y = 0) => truth(x + y, x === y));
  }

  private call({ name, args, at }: Extract<Expression, { kind: "call" }>): Part {
    const parts = args.map((each) => this.part(each));
    const plain = Object.hasOwn(PLAIN, name) ? PLAIN[name] : undefined;
    if (plain) {
      counted(name, parts, plain.args, at);
      const dimension = common(parts, `what ${name} takes`, at);
      if (plain.of === "number" && dimension !== null && !isNumber(dimension))
        throw new FormulaError(`${name} takes a plain number, this is in ${dimensionText(dimension)}`, at);
      return mapped(plain.gives === "number" ? NUMBER : dimension, parts, plain.call);
    }
    if (name === "sqrt") {
      counted(name, parts, 1, at);
      const dimension = parts[0]?.dimension ?? null;
      return mapped(dimension && raised(dimension, 0.5), parts, (x = 0) => Math.sqrt(x));
    }
    const remembering = Object.hasOwn(REMEMBERING, name) ? REMEMBERING[name] : undefined;
    if (remembering) return this.remembering(name, remembering, parts, at);
    throw new FormulaError(`there is no function “${name}”; there are ${FUNCTIONS.join(", ")}`, at);
  }

  private remembering(name: string, { constant: takes, gives, run }: Remembering, parts: Part[], at: number): Part {
    counted(name, parts, takes === null ? 1 : 2, at);
    const [of, beside] = parts as [Part, Part | undefined];
    const by = beside === undefined ? 0 : beside.constant;
    if (by === null || (takes !== null && !(by > 0)))
      throw new FormulaError(`the second of ${name} is a number above 0${takes === "period" ? "" : ` [${takes}]`}`, at);
    const backS = takes === "s" ? by : takes === "Hz" ? 1 / by : 0;
    if (of.leadS + backS > LOOK_BACK_MAX_S)
      throw new FormulaError(`it looks ${of.leadS + backS} s back; ${LOOK_BACK_MAX_S} s is the most`, at);
    return {
      dimension: gives ? times(of.dimension ?? NUMBER, gives) : of.dimension,
      constant: null,
      leadS: of.leadS + backS,
      run: (rows) => run(rows.times, of.run(rows), by, rows.from),
    };
  }
}

/** 1 or 0; NaN where what it is judged from is missing. */
function truth(of: number, is: boolean): number {
  return Number.isNaN(of) ? Number.NaN : is ? 1 : 0;
}

function constant(value: number): Part {
  return {
    dimension: null,
    constant: value,
    leadS: 0,
    run: ({ times: rows }) => new Float64Array(rows.length).fill(value),
  };
}

function mapped(dimension: Dimension | null, parts: readonly Part[], call: (...values: number[]) => number): Part {
  const constants = parts.map((part) => part.constant);
  if (constants.every((value) => value !== null)) return { ...constant(call(...constants)), dimension };
  return {
    dimension,
    constant: null,
    leadS: Math.max(...parts.map(({ leadS }) => leadS)),
    run: (rows) => {
      const [one, two, three] = parts.map((part) => part.run(rows)) as [Float64Array, Float64Array?, Float64Array?];
      // by how many there are: min and max take as many as they are given
      if (two === undefined) return one.map((value) => call(value));
      if (three === undefined) return one.map((value, row) => call(value, two[row] as number));
      return one.map((value, row) => call(value, two[row] as number, three[row] as number));
    },
  };
}

function product(one: Part, other: Part, power: 1 | -1): Dimension | null {
  if (one.dimension === null && other.dimension === null) return null;
  return times(one.dimension ?? NUMBER, raised(other.dimension ?? NUMBER, power));
}

/** The one dimension that all have; plain numbers as they are written go with any. */
function common(parts: readonly Part[], what: string, at: number): Dimension | null {
  const [first, ...others] = parts.flatMap(({ dimension }) => (dimension === null ? [] : [dimension]));
  for (const other of others)
    if (first && !same(first, other))
      throw new FormulaError(`${what} has two units: ${dimensionText(first)} and ${dimensionText(other)}`, at);
  return first ?? null;
}

function counted(name: string, parts: readonly Part[], wanted: number, at: number): void {
  if (parts.length !== wanted)
    throw new FormulaError(`${name} takes ${wanted === 1 ? "one value" : `${wanted} values`}, not ${parts.length}`, at);
}
