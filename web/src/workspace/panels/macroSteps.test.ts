import { expect, test } from "vitest";
import { fieldsOf, KINDS, linesOf, moved, type Step, type StepField, shown, stepsOf, written } from "./macroSteps";

const field = (step: Step, key: string) => fieldsOf(step).find((each) => each.key === key) as StepField;

test("what a form shows of any step is that step again", () => {
  for (const { first } of Object.values(KINDS))
    for (const each of fieldsOf(first)) expect(written(first, each, shown(first, each))).toEqual(first);
  const some = { do: "write", name: "CHOPCONF", axis: 1, fields: { toff: 3, tbl: 2 } } as Step;
  expect(shown(some, field(some, "to"))).toBe("toff 3, tbl 2");
  expect(written(some, field(some, "to"), "toff 3, tbl 2")).toEqual(some);
});

test("a write has a value or fields, never both", () => {
  const write = KINDS.write.first;
  const to = field(write, "to");
  expect(written(write, to, " 0x10 ")).toEqual({ do: "write", name: "", axis: 0, value: 16 });
  expect(written(write, to, "toff=4")).toEqual({ do: "write", name: "", axis: 0, fields: { toff: 4 } });
  for (const wrong of ["", "toff", "toff 1.5", "toff 1 2", "1, 2"]) expect(written(write, to, wrong)).toBeNull();
  expect(written(write, field(write, "axis"), "")).toEqual({ do: "write", name: "", axis: null, value: 0 });
});

test("numbers keep to their bounds, and an axis is whole", () => {
  const { move, wait } = { move: KINDS.move.first, wait: KINDS.wait.first };
  expect(written(move, field(move, "target"), "-1,5")).toMatchObject({ target: -1.5 });
  for (const wrong of ["", "32", "-1", "1.5", "x"]) expect(written(move, field(move, "axis"), wrong)).toBeNull();
  expect(written(wait, field(wait, "seconds"), "-1")).toBeNull();
  expect(written(move, field(move, "relative"), "true")).toMatchObject({ relative: true });
});

test("lines and steps are the same, and what is none is told", () => {
  const steps = Object.values(KINDS).map(({ first }) => first);
  expect(stepsOf(linesOf(steps))).toEqual(steps);
  expect(stepsOf(linesOf([]))).toEqual([]);
  for (const wrong of ["", "{}", "[1]", '[{"axis": 0}]', "[null]", "["]) expect(stepsOf(wrong)).toBeNull();
});

test("a step of an unknown kind, and the lists in it, can be edited as a whole", () => {
  const step = { do: "blink", lamps: [1, 2] } as unknown as Step;
  const [whole, more] = fieldsOf(step) as [StepField, undefined];
  expect(more).toBeUndefined();
  expect(written(step, whole, shown(step, whole))).toEqual(step);
  expect(written(step, whole, '{"do": "blink", "lamps": [3]}')).toEqual({ do: "blink", lamps: [3] });
  for (const wrong of ["", "{", '{"lamps": [3]}', '{"do": "wait"}, {"do": "wait"}'])
    expect(written(step, whole, wrong)).toBeNull();
});

test("a step goes elsewhere", () => {
  const [one, two, three] = Object.values(KINDS).map(({ first }) => first) as [Step, Step, Step];
  expect(moved([one, two, three], 0, 1)).toEqual([two, one, three]);
  expect(moved([one, two, three], 2, 1)).toEqual([one, three, two]);
});
