import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";

export type TwinState = Schemas["TwinState"];
export type TwinLook = Schemas["TwinLook"];

export const TWIN_KEY = ["twin"];
/** The numbers beside the picture, for people to read: faster would only flicker [ms]. */
const READ_MS = 400;
const LOOK_MS = 2000;

export interface Twin {
  state: TwinState | undefined;
  error: unknown;
  /** it is being started or ended */
  busy: boolean;
  show: (what: Schemas["TwinShow"]) => void;
  end: () => void;
  again: () => void;
}

/** The one 3D view of the server: how it is, on and off. */
export function useTwin(): Twin {
  const queries = useQueryClient();
  const query = useQuery({
    queryKey: TWIN_KEY,
    queryFn: () => api.GET("/api/v1/twin"),
    refetchInterval: ({ state }) => (state.data?.state === "on" ? READ_MS : LOOK_MS),
  });
  const seen = (state: TwinState) => queries.setQueryData(TWIN_KEY, state);
  const show = useMutation({
    mutationFn: (body: Schemas["TwinShow"]) => api.POST("/api/v1/twin", { body }),
    onSuccess: seen,
    onError: () => void queries.invalidateQueries({ queryKey: TWIN_KEY }),
  });
  const end = useMutation({
    mutationFn: () => api.DELETE("/api/v1/twin"),
    onSuccess: seen,
  });
  return {
    state: query.data,
    error: show.error ?? end.error ?? (query.data === undefined ? query.error : null),
    busy: show.isPending || end.isPending,
    show: show.mutate,
    end: end.mutate,
    again: () => void query.refetch(),
  };
}

/** Whether somebody looks at another axis: there is one view for everybody. */
export function othersAxis(state: TwinState, device: string, axis: number): boolean {
  return state.state === "on" && state.viewers > 0 && (state.device !== device || state.axis !== axis);
}
