mod latvox {
    tonic::include_proto!("latvox.v1");
}
use latvox::{lattice, voxelize_spec, voxelizer_client::VoxelizerClient};

#[tokio::main]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let vertices: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.];
    let triangles: [u32; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let mut mesh: Vec<u8> = vertices.iter().flat_map(|number| number.to_le_bytes()).collect();
    mesh.extend(triangles.iter().flat_map(|number| number.to_le_bytes()));
    let named = lattice::Kind::Named(latvox::NamedLattice::Bcc as i32);
    let spec = latvox::VoxelizeSpec {
        lattice: Some(latvox::Lattice { kind: Some(named) }),
        sampling: Some(voxelize_spec::Sampling::Resolution(32)),
        raw_mesh: Some(latvox::RawMesh { vertices: 4, triangles: 4, ..Default::default() }),
        ..Default::default()
    };
    let address = std::env::args().nth(1).ok_or("usage: tetrahedron ADDRESS")?;
    let mut client = VoxelizerClient::connect(format!("http://{address}")).await?;
    let request = latvox::VoxelizeSmallRequest { spec: Some(spec), mesh };
    let summary = client.voxelize_small(request).await?.into_inner().summary.ok_or("no summary")?;
    let digest = summary.certificate.ok_or("no certificate")?.digest;
    println!("{} voxels, digest {digest}", summary.voxels);
    Ok(())
}
