import { useQuery, useQueryClient } from "@tanstack/react-query";
import { ApiError, api, client, problemOf, type Schemas } from "../../api/client";
import { decodeFrame } from "../../live/frames";
import type { Piece } from "./ZoomData";

export type Recording = Schemas["RecordingInfo"];
export type RecordingDetail = Schemas["RecordingDetail"];
export type Mark = Schemas["MarkOut"];
export type Figures = Schemas["FiguresOut"];
export type Comparison = Schemas["Comparison"];
export type Replay = Schemas["Replay"];
export type Start = Schemas["RecordingStart"];

export function isRunning({ state }: { state: Recording["state"] }): boolean {
  return state === "waiting" || state === "recording";
}

/** So many recordings are listed at first, and more with each wish for more. */
export const PAGE = 100;
export const PAGE_MAX = 1000;

/**
 * The latest recordings, looked at once a second while one runs, more often while a search is not complete, else now and
 * then: others start them too.
 */
export function useRecordings(search = "", limit = PAGE) {
  return useQuery({
    queryKey: ["recordings", search, limit],
    queryFn: () => api.GET("/api/v1/recordings", { query: { limit, ...(search && { search }) } }),
    refetchInterval: ({ state: { data } }) => (data?.unread ? 300 : data?.recordings.some(isRunning) ? 1000 : 4000),
    placeholderData: (before) => before,
  });
}

/** One recording without its figures: these take a reading of all its rows. */
export function useRecording(id: string) {
  return useQuery({
    queryKey: ["recording", id],
    queryFn: async (): Promise<RecordingDetail> =>
      (await api.GET("/api/v1/recordings/{recording}", {
        path: { recording: id },
        query: { figures: false },
      })) as RecordingDetail, // without `format` it is no file
    refetchInterval: (query) => (query.state.data && isRunning(query.state.data) ? 1000 : false),
    retry: false,
  });
}

export function useFigures(id: string, window: readonly [number, number] | null, revision: number, enabled: boolean) {
  const query = window ? { from_s: window[0], to_s: window[1] } : {};
  return useQuery({
    queryKey: ["figures", id, window, revision],
    queryFn: ({ signal }) =>
      api.GET("/api/v1/recordings/{recording}/figures", { path: { recording: id }, query, signal }),
    enabled,
    placeholderData: (before) => before,
    staleTime: Number.POSITIVE_INFINITY,
    retry: false,
  });
}

/** A stretch of a recording as a plot needs it: a binary frame, viewed in place. */
export async function fetchPiece(id: string, window: readonly [number, number] | null, points: number): Promise<Piece> {
  const { data, error, response } = await client.GET("/api/v1/recordings/{recording}/plot", {
    params: {
      path: { recording: id },
      query: { format: "frame", points, ...(window ? { from_s: window[0], to_s: window[1] } : {}) },
    },
    parseAs: "arrayBuffer",
  });
  if (error !== undefined || data === undefined) throw new ApiError(problemOf(error));
  const { time, columns } = decodeFrame(data as unknown as ArrayBuffer);
  const from = window?.[0] ?? Number.NEGATIVE_INFINITY;
  const to = window?.[1] ?? Number.POSITIVE_INFINITY;
  const rows = Number(response.headers.get("stepscope-rows") ?? time.length);
  return { from, to, x: time, columns, exact: rows <= time.length };
}

/** What changes recordings. Each throws an ApiError; the lists are looked at anew. */
export function useChanges() {
  const queries = useQueryClient();
  const done = <T>(answer: Promise<T>): Promise<T> =>
    answer.finally(() => {
      void queries.invalidateQueries({ queryKey: ["recordings"] });
      void queries.invalidateQueries({ queryKey: ["recording"] });
    });
  const figures = { queryKey: ["figures"] };
  // Those under way may have been read before, and would count as of now: they are ended first.
  const measured = <T>(answer: Promise<T>): Promise<T> =>
    done(answer).finally(() => void queries.cancelQueries(figures).then(() => queries.invalidateQueries(figures)));
  const path = (recording: string) => ({ path: { recording } });
  return {
    start: (body: Start) => done(api.POST("/api/v1/recordings", { body })),
    stop: (id: string) => done(api.POST("/api/v1/recordings/{recording}/stop", path(id))),
    mark: (id: string, text: string) =>
      done(api.POST("/api/v1/recordings/{recording}/marks", { ...path(id), body: { text } })),
    addFile: (id: string, file: File) =>
      measured(
        api.POST("/api/v1/recordings/{recording}/added", {
          ...path(id),
          query: { name: file.name.slice(-100) },
          body: file as unknown as string,
          bodySerializer: (body: unknown) => body,
          headers: { "Content-Type": "text/csv" },
        } as never),
      ),
    alignFile: (recording: string, number: number, body: Schemas["Align"]) =>
      measured(api.PATCH("/api/v1/recordings/{recording}/added/{number}", { path: { recording, number }, body })),
    removeFile: (recording: string, number: number) =>
      measured(api.DELETE("/api/v1/recordings/{recording}/added/{number}", { path: { recording, number } })),
    label: (id: string, label: Schemas["RecordingLabel"]) =>
      done(api.PATCH("/api/v1/recordings/{recording}", { ...path(id), body: label })),
    remove: (id: string) =>
      api
        .DELETE("/api/v1/recordings/{recording}", path(id))
        .finally(() => void queries.invalidateQueries({ queryKey: ["recordings"] })),
    replay: (id: string) => done(api.POST("/api/v1/recordings/{recording}/replay", { ...path(id), body: {} })),
  };
}

export function downloadHref(id: string, format: "csv" | "parquet"): string {
  return `/api/v1/recordings/${encodeURIComponent(id)}?format=${format}`;
}

/** One HTML file with plots, marks and figures: of the stretch that is shown, or of all; with a prediction of an axis. */
export function reportHref(id: string, window: readonly [number, number] | null, predict = ""): string {
  const asked = new URLSearchParams(window === null ? {} : { from_s: String(window[0]), to_s: String(window[1]) });
  if (predict !== "") asked.set("predict", predict);
  return `/api/v1/recordings/${encodeURIComponent(id)}/report${asked.size > 0 ? `?${asked}` : ""}`;
}

/** What people call it. */
export function titleOf({ id, name }: { id: string; name: string }): string {
  return name || id;
}
