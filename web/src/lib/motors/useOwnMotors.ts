import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";

/** As many as the server keeps. */
const ALL = 1000;

interface Kept {
  name: string;
  figures: Schemas["MotorFigures"];
  /** the name that it had before */
  instead?: string | null;
}

/** Motors are asked for anew, wherever they are shown, before a change counts as done. */
function useAskAnew() {
  const queries = useQueryClient();
  return () => queries.invalidateQueries({ queryKey: ["motors"] });
}

/** Keeps a motor of one's own, instead of the one of that name. */
export function useKeepMotor() {
  const onSettled = useAskAnew();
  return useMutation({
    mutationFn: async ({ name, figures, instead }: Kept) => {
      await api.PUT("/api/v1/motors/{motor}", { path: { motor: name }, body: figures });
      // behind the new one: what fails between leaves one too many, not one too few
      if (instead && instead !== name) await api.DELETE("/api/v1/motors/{motor}", { path: { motor: instead } });
    },
    onSettled,
  });
}

export function useDeleteMotor() {
  const onSettled = useAskAnew();
  return useMutation({
    mutationFn: (name: string) => api.DELETE("/api/v1/motors/{motor}", { path: { motor: name } }),
    onSettled,
  });
}

/** All motors of one's own, by name. */
export function useOwnMotors() {
  return useQuery({
    queryKey: ["motors", { own: true }],
    queryFn: async () => (await api.GET("/api/v1/motors", { query: { own: true, limit: ALL } })).motors,
  });
}
