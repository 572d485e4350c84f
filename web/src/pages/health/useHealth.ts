import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { ApiError, api, problemOf, type Schemas, unwrap } from "../../api/client";

export type Health = Schemas["HealthDetails"];
export type DeviceHealth = Schemas["DeviceHealth"];
export type Role = Schemas["TokenAdd"]["role"];

export function useHealth() {
  return useQuery({
    queryKey: ["health"],
    queryFn: async () => unwrap(await api.GET("/api/v1/health/details")),
    refetchInterval: 1000,
  });
}

export function useTokens(wanted: boolean) {
  return useQuery({
    queryKey: ["tokens"],
    queryFn: async () => unwrap(await api.GET("/api/v1/tokens")),
    enabled: wanted,
    refetchInterval: 5000,
  });
}

export function useTokenChanges() {
  const queries = useQueryClient();
  const onSettled = () => queries.invalidateQueries({ queryKey: ["tokens"] });
  const add = useMutation({
    mutationFn: async (body: Schemas["TokenAdd"]) => unwrap(await api.POST("/api/v1/tokens", { body })),
    onSettled,
  });
  const revoke = useMutation({
    mutationFn: async (name: string) => {
      const answer = await api.DELETE("/api/v1/tokens/{name}", { params: { path: { name } } });
      if (answer.error !== undefined) throw new ApiError(problemOf(answer.error));
    },
    onSettled,
  });
  return { add, revoke };
}
