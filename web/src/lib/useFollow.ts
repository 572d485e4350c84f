import { useEffect, useRef, useState } from "react";

export interface Following<Result> {
  /** the latest answer; while a newer one is awaited, the one before */
  result: Result | undefined;
  /** what is shown answers an older question */
  stale: boolean;
  error: unknown;
  retry: () => void;
}

interface State<Result> {
  question: string | null;
  result: Result | undefined;
  error: unknown;
}

/**
 * An answer that follows its question as fast as it can be answered: one question is on its way at any time, and when
 * it is answered the latest one goes. So a handle that is dragged gets an answer a round trip, however many pixels it
 * passes, and no answer is waited for that nobody wants any more.
 */
export function useFollow<Body, Result>(
  body: Body | null,
  call: (body: Body, signal: AbortSignal) => Promise<Result>,
): Following<Result> {
  const question = body === null ? null : JSON.stringify(body);
  const [state, setState] = useState<State<Result>>({ question: null, result: undefined, error: null });
  const [attempt, setAttempt] = useState(0);
  const wanted = useRef<string | null>(null);
  const busy = useRef(false);
  const alive = useRef<AbortController | null>(null);
  const ask = useRef(call);
  ask.current = call;

  useEffect(() => {
    const controller = new AbortController();
    alive.current = controller;
    busy.current = false;
    return () => controller.abort();
  }, []);

  // biome-ignore lint/correctness/useExhaustiveDependencies: another attempt asks the same question once more
  useEffect(() => {
    wanted.current = question;
    const controller = alive.current;
    if (question === null || busy.current || controller === null) return;
    const next = async (asked: string) => {
      busy.current = true;
      let outcome: Pick<State<Result>, "error"> & { result?: Result };
      try {
        outcome = { error: null, result: await ask.current(JSON.parse(asked) as Body, controller.signal) };
      } catch (error) {
        outcome = { error };
      }
      if (controller.signal.aborted) return;
      busy.current = false;
      setState((before) => ({ question: asked, result: outcome.result ?? before.result, error: outcome.error }));
      if (wanted.current !== null && wanted.current !== asked) void next(wanted.current);
    };
    void next(question);
  }, [question, attempt]);

  return {
    result: state.result,
    stale: state.question !== question || state.error !== null,
    error: state.question === question ? state.error : null,
    retry: () => setAttempt((count) => count + 1),
  };
}
