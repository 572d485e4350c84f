import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";

export type Health = Schemas["HealthDetails"];
export type DeviceHealth = Schemas["DeviceHealth"];
export type Role = Schemas["TokenAdd"]["role"];

export function useHealth() {
  return useQuery({
    queryKey: ["health"],
    queryFn: () => api.GET("/api/v1/health/details"),
    refetchInterval: 1000,
  });
}

export function useTokens(wanted: boolean) {
  return useQuery({
    queryKey: ["tokens"],
    queryFn: () => api.GET("/api/v1/tokens"),
    enabled: wanted,
    refetchInterval: 5000,
  });
}

export function useTokenChanges() {
  const queries = useQueryClient();
  const onSettled = () => queries.invalidateQueries({ queryKey: ["tokens"] });
  const add = useMutation({
    mutationFn: (body: Schemas["TokenAdd"]) => api.POST("/api/v1/tokens", { body }),
    onSettled,
  });
  const revoke = useMutation({
    mutationFn: (name: string) => api.DELETE("/api/v1/tokens/{name}", { path: { name } }),
    onSettled,
  });
  return { add, revoke };
}
